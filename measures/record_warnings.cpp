#include "measures/record_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hertzline::measures {

namespace {

/// A share of the horn's velocity; a quieter output has not passed the chain.
constexpr double silence = 1e-9;

double burst_s(const Drive& drive) {
    return drive.cycles / drive.frequency_hz;
}

/// Rounded up to two digits, so that it can be typed.
double rounded_up(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
    return std::ceil(value / unit * (1 - 1e-12)) * unit;
}

std::string duration_setting(double seconds) {
    return fmt::format("output.duration_s={:.2g}", rounded_up(seconds));
}

/// When the ringing will have fallen to its share of the peak, extrapolated from the second half of its record, with
/// a margin of a twentieth; absent where it does not fall.
std::optional<double> ringing_over_s(std::span<const double> after_burst, double duration_s, double rate_hz,
                                     double last, double peak) {
    const std::span<const double> late =
        after_burst.subspan(after_burst.size() / 2);  // at first it falls faster
    const std::size_t half = late.size() / 2;
    if (half == 0) {
        return std::nullopt;
    }
    const double decline = std::log(peak_of(late.first(half)) / peak_of(late.subspan(half)));
    const double decline_per_s = decline * rate_hz / static_cast<double>(half);
    if (!(decline_per_s > 0) || !std::isfinite(decline_per_s)) {
        return std::nullopt;
    }
    return 1.05 * (duration_s + std::log(last / (ringing_share * peak)) / decline_per_s);
}

/// Samples in the burst, and in a period of the drive.
std::size_t burst_samples(const Scene& scene) noexcept {
    return static_cast<std::size_t>(burst_s(scene.drive) * scene.output.sample_rate_hz);
}
std::size_t period_samples(const Scene& scene) noexcept {
    return static_cast<std::size_t>(std::ceil(scene.output.sample_rate_hz / scene.drive.frequency_hz));
}

/// Whether the record covers two periods after the burst.
bool shows_ringing(const Scene& scene, std::size_t samples) noexcept {
    return samples >= burst_samples(scene) + 2 * period_samples(scene);
}

/// The horn's largest velocity [m/s].
double horn_velocity(const Drive& drive) noexcept {
    return 2 * std::numbers::pi * drive.frequency_hz * std::abs(drive.amplitude_m);
}

std::optional<std::string> ringing(const Scene& scene, std::span<const double> v_out, double peak) {
    if (!shows_ringing(scene, v_out.size())) {
        return fmt::format(
            "the run ends before its ringing shows, less than two periods of the drive after the burst; a "
            "longer one, such as {}, would tell how complete its spectrum is",
            duration_setting(2 * scene.output.duration_s));
    }
    const std::optional<double> ratio = ringing_ratio(scene, v_out);
    if (!ratio || *ratio <= ringing_share) {
        return std::nullopt;
    }
    const auto enough = ringing_over_s(v_out.subspan(burst_samples(scene)), scene.output.duration_s,
                                       scene.output.sample_rate_hz, *ratio * peak, peak);
    return fmt::format(
        "v_out still rings at {:.1f} % of its peak when the run ends, which changes its spectrum "
        "(ringing_ratio); {}",
        100 * *ratio,
        enough
            ? "about " + duration_setting(*enough) + " would let it fall to 1 %"
            : std::string("it has not fallen since the burst, so nothing can be said of when it will have"));
}

std::optional<std::string> cut_off(const Scene& scene) {
    const double nyquist = scene.output.sample_rate_hz / 2;
    const double highest = static_cast<double>(SpectrumAnalyser::max_harmonics) * scene.drive.frequency_hz;
    if (highest <= nyquist) {
        return std::nullopt;
    }
    return fmt::format(
        "harmonics above half the sample rate ({:g} Hz) are not reported, and samples are not filtered: what "
        "lies above appears below; output.sample_rate_hz={:.2g} would show ten harmonics",
        nyquist, rounded_up(4 * highest));
}

}  // namespace

double burst_shown_ratio(const Scene& scene) noexcept {
    return std::min(1.0, scene.output.duration_s / burst_s(scene.drive));
}

std::optional<double> ringing_ratio(const Scene& scene, std::span<const double> v_out) noexcept {
    const double peak = peak_of(v_out);
    if (scene.drive.repetition_hz > 0 || !(peak > silence * horn_velocity(scene.drive)) ||
        !shows_ringing(scene, v_out.size())) {
        return std::nullopt;
    }
    return peak_of(v_out.last(period_samples(scene))) / peak;
}

std::vector<std::string> band_warnings(std::string_view output, const SpectrumSummary& spectrum) {
    if (spectrum.below_db && *spectrum.below_db > 0) {
        return {fmt::format(
            "{} is {:.1f} dB stronger below {:g} Hz than anywhere above (below_db): its bands, harmonics and "
            "distortion leave that out",
            output, *spectrum.below_db, spectrum.lowest_hz)};
    }
    if (spectrum.band_20db && spectrum.band_20db->low_hz <= spectrum.lowest_hz * (1 + 1e-12)) {
        return {fmt::format(
            "the -20 dB band of {} begins at {:g} Hz, from where on it is looked for: it goes on below",
            output, spectrum.lowest_hz)};
    }
    return {};
}

std::vector<std::string> record_warnings(const Scene& scene, std::span<const double> v_out) {
    std::vector<std::string> warnings;
    const Drive& drive = scene.drive;
    const double horn = horn_velocity(drive);
    const double peak = peak_of(v_out);
    if (horn == 0) {
        return warnings;
    }
    if (scene.output.duration_s < burst_s(drive)) {
        warnings.push_back(
            fmt::format("the run ends at {:g} s, within the burst of {:g} s: peaks and spectrum are those of "
                        "its beginning; {} would hold the burst",
                        scene.output.duration_s, burst_s(drive), duration_setting(1.5 * burst_s(drive))));
    } else if (peak < silence * horn) {
        warnings.emplace_back(
            "v_out is silent: the wave does not reach the end of the chain within the run "
            "(output.duration_s), or does not pass the chain");
    } else if (drive.repetition_hz == 0) {
        if (const auto found = ringing(scene, v_out, peak)) {
            warnings.push_back(*found);
        }
    }
    if (const auto found = cut_off(scene)) {
        warnings.push_back(*found);
    }
    return warnings;
}

std::vector<std::string> switching_warnings(std::span<const double> switching_db) {
    std::vector<std::size_t> lines;
    for (std::size_t k = 0; k < switching_db.size(); ++k) {
        if (switching_db[k] >= switching_limit_db) {
            lines.push_back(k + 1);
        }
    }
    if (lines.empty()) {
        return {};
    }
    const bool several = lines.size() > 1;
    return {fmt::format(
        "harmonic{} {} of v_out {} by half or more the jumps of its formula when the last contact opens or "
        "closes, not a motion (switching_db)",
        several ? "s" : "", fmt::join(lines, ", "), several ? "are" : "is")};
}

}  // namespace hertzline::measures
