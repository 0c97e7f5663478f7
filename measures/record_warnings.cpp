#include "measures/record_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/model/drive.hpp"
#include "core/model/end.hpp"
#include "core/scene/elements.hpp"

namespace hertzline::measures {

namespace {

/// A share of the horn's velocity; a quieter output has not passed the chain.
constexpr double silence = 1e-9;

/// Rounded up to two digits, so that it can be typed.
double rounded_up(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
    return std::ceil(value / unit * (1 - 1e-12)) * unit;
}

std::string duration_setting(double seconds) {
    return fmt::format("output.duration_s={:.2g}", rounded_up(seconds));
}

/// Whether the record covers two periods after the burst, or after the start where there is no horn.
bool shows_ringing(const Scene& scene, std::size_t samples) {
    const double burst_s = scene.drive.kind == DriveKind::none ? 0 : first_burst_end_s(scene);
    const double burst_samples = std::floor(burst_s * scene.output.sample_rate_hz);
    return static_cast<double>(samples) >= burst_samples + 2 * static_cast<double>(period_samples(scene));
}

/// The largest velocity of any horn or of the spheres that start with one [m/s].
double velocity_given(const Scene& scene) {
    double largest = std::abs(scene.chain.impact_velocity_m_per_s);
    for (std::size_t element = 0; element < chains_of(scene); ++element) {
        largest = std::max(largest, largest_velocity(element_scene(scene, element).drive));
    }
    return largest;
}

std::optional<std::string> ringing(const Scene& scene, std::span<const double> v_out,
                                   std::optional<double> rung_down_s) {
    if (scene.drive.kind != DriveKind::none && !shows_ringing(scene, v_out.size())) {
        return fmt::format(
            "the run ends before its ringing shows, less than two periods of the drive after the burst; a "
            "longer one, such as {}, would tell how complete its spectrum is",
            duration_setting(2 * scene.output.duration_s));
    }
    const std::optional<double> ratio = ringing_ratio(scene, v_out);
    if (!ratio || *ratio <= ringing_share) {
        return std::nullopt;
    }
    return fmt::format(
        "v_out still rings at {:.1f} % of its peak when the run ends, which changes its spectrum "
        "(ringing_ratio); {}",
        100 * *ratio,
        rung_down_s ? duration_setting(*rung_down_s) + " lets it fall to 1 %"
                    : "a longer output.duration_s shows how far it falls");
}

std::optional<std::string> cut_off(const Scene& scene) {
    const double nyquist = scene.output.sample_rate_hz / 2;
    const double highest = static_cast<double>(SpectrumAnalyser::max_harmonics) * scene.drive.frequency_hz;
    if (highest <= nyquist) {
        return std::nullopt;
    }
    return fmt::format(
        "harmonics above half the sample rate ({:g} Hz) are not reported, and samples are not filtered: all "
        "energy above it is aliased; output.sample_rate_hz={:.2g} would show ten harmonics",
        nyquist, rounded_up(4 * highest));
}

/// Peaks between the samples of a motion that no horn drives.
std::optional<std::string> peaks_missed(const Scene& scene) {
    constexpr double fewest = 10;  // samples in a period: a peak between two is 5 % higher at most
    const double fastest_hz = fastest_contact_hz(scene);
    if (scene.output.sample_rate_hz >= fewest * fastest_hz) {
        return std::nullopt;
    }
    return fmt::format(
        "the contacts of this motion may have {:.2g} Hz, and with less than ten samples in a period of that "
        "peaks are missed; output.sample_rate_hz={:.2g} would show them",
        fastest_hz, rounded_up(fewest * fastest_hz));
}

/// A burst of the horn that is not over at the end of the run.
struct CutBurst {
    bool first = false;
    double begin_s = 0;
    double end_s = 0;
    double enough_s = 0;  ///< a duration that cuts none
};

std::optional<CutBurst> cut_burst(const Scene& scene) {
    constexpr double to_ring_down = 1.5;
    constexpr double no_pause = 0.999;  // a burst's part of the period
    if (scene.drive.kind == DriveKind::none) {
        return std::nullopt;
    }
    const double duration_s = scene.output.duration_s;
    const double begin_s = scene.drive.start_s + std::ranges::min(element_delays_s(scene));
    const double end_s = first_burst_end_s(scene);
    const bool repeats = scene.drive.repetition_hz > 0;
    const double period_s = 1 / scene.drive.repetition_hz;
    if (duration_s < end_s) {
        return CutBurst{true, begin_s, end_s,
                        repeats ? begin_s + period_s : rounded_up(to_ring_down * end_s)};
    }
    if (!repeats || end_s - begin_s > no_pause * period_s) {
        return std::nullopt;
    }
    const double periods_before_s = std::floor((duration_s - begin_s) / period_s) * period_s;
    const double begun_s = duration_s - periods_before_s - begin_s;
    const bool cut = begun_s > 1 / scene.drive.frequency_hz && begun_s < (1 - 1e-9) * (end_s - begin_s);
    return cut ? std::optional(CutBurst{false, periods_before_s + begin_s, periods_before_s + end_s,
                                        periods_before_s + begin_s + period_s})
               : std::nullopt;
}

}  // namespace

std::vector<std::string> run_warnings(const Scene& scene) {
    std::vector<std::string> warnings;
    if (velocity_given(scene) == 0) {
        return warnings;
    }
    if (const auto cut = cut_burst(scene)) {
        const std::string advice = fmt::format("output.duration_s={:.9g} would hold {}", cut->enough_s,
                                               cut->first ? "the burst" : "whole bursts");
        const bool begun = scene.output.duration_s > cut->begin_s;
        warnings.push_back(
            begun ? fmt::format("the run ends at {:g} s, within {} burst, which ends at {:g} s: {}; {}",
                                scene.output.duration_s, cut->first ? "the" : "a", cut->end_s,
                                cut->first ? "peaks and spectrum are those of its beginning"
                                           : "the spectrum has a part of it",
                                advice)
                  : fmt::format(
                        "the run ends at {:g} s, before the burst, which begins at {:g} s: the horn does not "
                        "move; {}",
                        scene.output.duration_s, cut->begin_s, advice));
    }
    if (const auto found = scene.drive.kind == DriveKind::none ? peaks_missed(scene) : cut_off(scene)) {
        warnings.push_back(*found);
    }
    return warnings;
}

double burst_shown_ratio(const Scene& scene) {
    if (scene.drive.kind == DriveKind::none) {
        return 1;
    }
    const double burst_s = burst_duration_s(scene.drive);
    const double begin_s = first_burst_end_s(scene) - burst_s;
    return std::clamp((scene.output.duration_s - begin_s) / burst_s, 0.0, 1.0);
}

std::optional<double> ringing_ratio(const Scene& scene, std::span<const double> v_out) {
    const double peak = peak_of(v_out);
    if (scene.drive.repetition_hz > 0 || !(peak > silence * velocity_given(scene)) ||
        !shows_ringing(scene, v_out.size())) {
        return std::nullopt;
    }
    return peak_of(v_out.last(period_samples(scene))) / peak;
}

std::vector<std::string> band_warnings(std::string_view output, const SpectrumSummary& spectrum) {
    if (!spectrum.strongest_hz && !spectrum.harmonics_db.empty()) {
        return {
            fmt::format("{} has no bands: the search begins at {:g} Hz (--band-from), "
                        "above half the sample rate",
                        output, spectrum.lowest_hz)};
    }
    if (spectrum.below_db && *spectrum.below_db > 0) {
        return {fmt::format(
            "{} is {:.1f} dB stronger below {:g} Hz than anywhere above (below_db): its bands, harmonics and "
            "distortion leave that out",
            output, *spectrum.below_db, spectrum.lowest_hz)};
    }
    if (spectrum.lowest_hz > 0 && spectrum.band_20db &&
        spectrum.band_20db->low_hz <= spectrum.lowest_hz * (1 + 1e-12)) {
        return {
            fmt::format("the -20 dB band of {} begins at {:g} Hz, where the search begins: it may go on "
                        "below, where "
                        "--band-from 0 looks",
                        output, spectrum.lowest_hz)};
    }
    return {};
}

double next_duration(double seconds) noexcept {
    constexpr double beyond = 1 + 1e-9;
    return rounded_up(seconds * beyond);
}

std::size_t period_samples(const Scene& scene) noexcept {
    return static_cast<std::size_t>(std::ceil(scene.output.sample_rate_hz / scene.drive.frequency_hz));
}

std::vector<std::string> record_warnings(const Scene& scene, std::span<const double> v_out,
                                         std::optional<double> rung_down_s) {
    std::vector<std::string> warnings = run_warnings(scene);
    const double given =
        velocity_given(is_array(scene) ? element_scene(scene, middle_element(scene)) : scene);
    if (const auto cut = cut_burst(scene); given == 0 || (cut && cut->first)) {
        return warnings;
    }
    std::optional<std::string> found;
    if (v_out.size() < 2 * period_samples(scene)) {
        found =
            "the run has less than two periods of drive.frequency_hz, too few to tell its harmonics apart; a "
            "longer output.duration_s, or a higher output.sample_rate_hz, shows them";
    } else if (peak_of(v_out) < silence * given) {
        found =
            "v_out is silent: the wave does not reach the end of the chain within the run "
            "(output.duration_s), or does not pass the chain";
    } else if (scene.drive.repetition_hz == 0) {
        found = ringing(scene, v_out, rung_down_s);
    }
    if (found) {
        warnings.insert(warnings.begin(), *std::move(found));
    }
    return warnings;
}

std::vector<std::string> switching_warnings(std::span<const double> switching_db) {
    std::vector<std::size_t> lines;
    for (std::size_t k = 0; k < switching_db.size(); ++k) {
        if (std::abs(switching_db[k]) >= switching_limit_db) {
            lines.push_back(k + 1);
        }
    }
    if (lines.empty()) {
        return {};
    }
    const bool several = lines.size() > 1;
    return {fmt::format(
        "harmonic{} {} of v_out {} changed by a factor of two or more by the jumps of its formula "
        "when the last contact opens or closes, which no body does (switching_db)",
        several ? "s" : "", fmt::join(lines, ", "), several ? "are" : "is")};
}

}  // namespace hertzline::measures
