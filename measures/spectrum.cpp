#include "hertzline/spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fftw3.h>

namespace hertzline {
namespace {

// Fourfold padding puts a bin within 1/8 of the record's resolution of any line; a parabola through the three bins
// around it then errs by less than 0.01 dB, even for a tone that is cut off sharply (0.28 dB at twofold padding).
constexpr std::size_t padding = 4;
constexpr std::size_t max_samples = std::size_t{1} << 28;  // FFTW's plain interface counts in int

// How far from k f a line may sit, as a fraction of f: wide enough for the main lobe of a burst of ten cycles
// or more, narrow enough that the sub-harmonic's and the harmonic's neighbourhoods stay apart.
constexpr double neighbourhood = 0.1;

bool is_smooth(std::size_t n) {
    for (const std::size_t prime : {2U, 3U, 5U, 7U}) {
        while (n % prime == 0) {
            n /= prime;
        }
    }
    return n == 1;
}

/// The smallest even number from n on that FFTW transforms fast (factors 2, 3, 5, 7 only).
std::size_t fast_size(std::size_t n) {
    n += n % 2;
    while (!is_smooth(n)) {
        n += 2;
    }
    return n;
}

double decibels(double ratio) {
    return ratio > 0 ? std::max(20 * std::log10(ratio), SpectrumAnalyser::floor_db)
                     : SpectrumAnalyser::floor_db;
}

/// Largest |sample|; absent when one is not finite.
std::optional<double> finite_peak_of(std::span<const double> record) {
    bool finite = true;
    for (const double v : record) {
        finite &= std::isfinite(v);
    }
    return finite ? std::optional(peak_of(record)) : std::nullopt;
}

/// Height of the parabola through the logarithms of three neighbours, the middle one the largest.
double parabola_top(double left, double middle, double right) {
    if (!(left > 0) || !(right > 0)) {
        return middle;
    }
    const double a = std::log(left / middle);
    const double c = std::log(right / middle);
    const double curvature = a + c;  // at most 0
    return curvature < 0 ? middle * std::exp(-(a - c) * (a - c) / (8 * curvature)) : middle;
}

void require_fundamental(double fundamental_hz) {
    if (!(fundamental_hz > 0) || !std::isfinite(fundamental_hz)) {
        throw std::invalid_argument("a spectrum needs a positive fundamental frequency");
    }
}

double square(double value) noexcept {
    return value * value;
}

}  // namespace

double peak_of(std::span<const double> values) {
    std::array<double, 8> peaks{};  // one would wait for itself at each value
    std::size_t i = 0;
    for (; i + peaks.size() <= values.size(); i += peaks.size()) {
        for (std::size_t lane = 0; lane < peaks.size(); ++lane) {
            peaks[lane] = std::max(peaks[lane], std::abs(values[i + lane]));
        }
    }
    for (; i < values.size(); ++i) {
        peaks[0] = std::max(peaks[0], std::abs(values[i]));
    }
    return std::ranges::max(peaks);
}

std::vector<double> level_differences_db(std::span<const double> harmonics, std::span<const double> others) {
    std::vector<double> differences;
    for (std::size_t k = 0; k < std::min(harmonics.size(), others.size()); ++k) {
        const double ratio = others[k] > 0 ? harmonics[k] / others[k] : std::numeric_limits<double>::max();
        differences.push_back(std::min(decibels(ratio), -SpectrumAnalyser::floor_db));
    }
    return differences;
}

/// A record as complex numbers, each of two neighbours: half as long a transform, from which take_powers() takes the record's own.
/// FFTW's r2c does the same, but takes a hundred times as long to plan, and its halfcomplex format has no vector instructions.
struct SpectrumAnalyser::Transform {
    /// In place. FFTW_ESTIMATE: the plan depends on the size alone, so the same record gives the same bits in every run.
    Transform(std::size_t pairs, double* values) {
        {
            const std::scoped_lock lock(planner);
            auto* const numbers = reinterpret_cast<fftw_complex*>(values);
            plan = fftw_plan_dft_1d(static_cast<int>(pairs), numbers, numbers, FFTW_FORWARD, FFTW_ESTIMATE);
        }
        if (plan == nullptr) {
            throw std::bad_alloc();
        }
        turns.reserve(pairs / 2 + 1);
        for (std::size_t bin = 0; bin <= pairs / 2; ++bin) {
            const double part = static_cast<double>(bin) / static_cast<double>(pairs);
            turns.push_back(std::polar(1.0, -std::numbers::pi * part));
        }
    }
    ~Transform() {
        const std::scoped_lock lock(planner);
        fftw_destroy_plan(plan);
    }
    Transform(const Transform&) = delete;
    Transform& operator=(const Transform&) = delete;

    static inline std::mutex planner;
    fftw_plan plan = nullptr;
    std::vector<std::complex<double>> turns;  // exp(-i pi bin / pairs), up to a quarter of a turn
};

SpectrumAnalyser::SpectrumAnalyser(std::size_t samples, double sample_rate_hz) : samples_(samples) {
    if (samples == 0 || samples > max_samples) {
        throw std::invalid_argument("a spectrum needs a record of 1 to 268435456 samples");
    }
    if (!(sample_rate_hz > 0) || !std::isfinite(sample_rate_hz)) {
        throw std::invalid_argument("a spectrum needs a positive sample rate");
    }
    padded_ = fast_size(padding * samples);
    last_bin_ = padded_ / 2;
    bin_hz_ = sample_rate_hz / static_cast<double>(padded_);
    buffer_.resize(padded_);
    powers_.resize(last_bin_ + 1);
    transform_ = std::make_unique<Transform>(last_bin_, buffer_.data());
}

SpectrumAnalyser::~SpectrumAnalyser() = default;

double SpectrumAnalyser::bytes_needed(double samples) noexcept {
    // The padded record in place, a half of that for the powers and the turns each, and FFTW's memory while it
    // transforms.
    return 3.0 * static_cast<double>(padding) * sizeof(double) * samples;
}

/// True when there is a spectrum: the record is finite and not silent. It is transformed scaled to a peak of
/// 1, so that no magnitude over- or underflows; ratios do not care, magnitudes() multiplies back.
bool SpectrumAnalyser::transform(std::span<const double> record) {
    if (record.size() > samples_) {
        throw std::invalid_argument("the record is longer than the spectrum was planned for");
    }
    const std::optional<double> peak = finite_peak_of(record);
    if (!peak || *peak == 0) {
        return false;
    }
    scale_ = *peak;
    const auto end =
        std::ranges::transform(record, buffer_.begin(), [scale = *peak](double v) { return v / scale; }).out;
    std::fill(end, buffer_.end(), 0.0);
    fftw_execute(transform_->plan);
    take_powers();
    return true;
}

/// With z_n = x_2n + i x_(2n+1) and Z its transform of N pairs: E = (Z_k + conj Z_(N-k)) / 2 is the transform of the
/// even samples, O = (Z_k - conj Z_(N-k)) / 2i that of the odd ones. X_k = E + t O and X_(N-k) = conj(E - t O), t =
/// exp(-i pi k / N). See Press et al., Numerical Recipes, section 12.3.
void SpectrumAnalyser::take_powers() noexcept {
    const std::size_t pairs = last_bin_;
    powers_[0] = square(buffer_[0] + buffer_[1]);
    powers_[pairs] = square(buffer_[0] - buffer_[1]);
    const double* const values = buffer_.data();
    const std::complex<double>* const turns = transform_->turns.data();
    double* const powers = powers_.data();
    for (std::size_t bin = 1; bin <= pairs / 2; ++bin) {
        const double* const near = &values[2 * bin];
        const double* const far = &values[2 * (pairs - bin)];
        const double even_re = 0.5 * (near[0] + far[0]);
        const double even_im = 0.5 * (near[1] - far[1]);
        const double odd_re = 0.5 * (near[1] + far[1]);
        const double odd_im = 0.5 * (far[0] - near[0]);
        const double re = turns[bin].real() * odd_re - turns[bin].imag() * odd_im;
        const double im = turns[bin].real() * odd_im + turns[bin].imag() * odd_re;
        powers[bin] = square(even_re + re) + square(even_im + im);
        powers[pairs - bin] = square(even_re - re) + square(even_im - im);
    }
}

/// Straight lines are drawn between the bins. @param frequency_hz from 0 to half the sample rate
double SpectrumAnalyser::magnitude_at(double frequency_hz) const noexcept {
    const double bin = std::min(frequency_hz / bin_hz_, static_cast<double>(last_bin_));
    const auto left = static_cast<std::size_t>(bin);
    const std::size_t right = std::min(left + 1, last_bin_);
    return std::lerp(magnitude(left), magnitude(right), bin - static_cast<double>(left));
}

/// Largest magnitude within half_width_hz of frequency_hz, between the bins too.
double SpectrumAnalyser::line(double frequency_hz, double half_width_hz) const noexcept {
    const auto last = static_cast<double>(last_bin_);
    const double nearest = std::min(std::round(frequency_hz / bin_hz_), last);
    const double low = std::min(std::ceil((frequency_hz - half_width_hz) / bin_hz_), nearest);
    const double high = std::clamp(std::floor((frequency_hz + half_width_hz) / bin_hz_), nearest, last);
    auto top = static_cast<std::size_t>(low);
    for (std::size_t bin = top; bin <= static_cast<std::size_t>(high); ++bin) {
        if (powers_[bin] > powers_[top]) {
            top = bin;
        }
    }
    if (top == 0 || top == last_bin_ || powers_[top - 1] > powers_[top] || powers_[top + 1] > powers_[top]) {
        return magnitude(top);  // on the slope of something that is larger outside
    }
    return parabola_top(magnitude(top - 1), magnitude(top), magnitude(top + 1));
}

/// Returns the band in which the magnitudes, with straight lines between the bins, reach the threshold.
std::optional<Band> SpectrumAnalyser::band_above(double threshold, double lowest_hz) const noexcept {
    std::optional<Band> band;
    const double power = threshold * threshold;
    const auto first = static_cast<std::size_t>(lowest_hz / bin_hz_) + 1;
    std::size_t last = last_bin_;  // most bins lie above all bands
    while (last > 0 && powers_[last - 1] < power) {
        --last;
    }
    double left_hz = lowest_hz;
    double left = square(magnitude_at(lowest_hz));
    for (std::size_t bin = first; bin <= last; ++bin) {
        const double right = powers_[bin];
        if (std::max(left, right) >= power) {
            const double right_hz = bin_hz_ * static_cast<double>(bin);
            const auto crossing = [&] {
                const double rise = std::sqrt(right) - std::sqrt(left);
                return rise != 0 ? left_hz + (right_hz - left_hz) * (threshold - std::sqrt(left)) / rise
                                 : left_hz;
            };
            const double from = left >= power ? left_hz : crossing();
            const double to = right >= power ? right_hz : crossing();
            band = {.low_hz = band ? band->low_hz : from,
                    .high_hz = to,
                    .occupied_hz = (band ? band->occupied_hz : 0) + (to - from)};
        }
        left_hz = bin_hz_ * static_cast<double>(bin);
        left = right;
    }
    return band;
}

void SpectrumAnalyser::add_bands(SpectrumSummary& summary) const {
    const double nyquist = bin_hz_ * static_cast<double>(last_bin_);
    if (summary.lowest_hz >= nyquist) {
        return;
    }
    // at lowest_hz itself, or at a bin above it
    double strongest = square(magnitude_at(summary.lowest_hz));
    summary.strongest_hz = summary.lowest_hz;
    double below = powers_[0];
    for (std::size_t bin = 0; bin <= last_bin_; ++bin) {
        const double frequency = bin_hz_ * static_cast<double>(bin);
        if (frequency < summary.lowest_hz) {
            below = std::max(below, powers_[bin]);
        } else if (powers_[bin] > strongest) {
            strongest = powers_[bin];
            summary.strongest_hz = frequency;
        }
    }
    const double maximum = std::sqrt(strongest);
    if (!(maximum > 0)) {
        summary.strongest_hz = std::nullopt;
        return;
    }
    summary.dc_db = decibels(magnitude(0) / maximum);
    summary.below_db = decibels(std::sqrt(below) / maximum);
    summary.band_6db = band_above(maximum * std::pow(10.0, -6.0 / 20), summary.lowest_hz);
    summary.band_20db = band_above(maximum * std::pow(10.0, -20.0 / 20), summary.lowest_hz);
}

std::size_t SpectrumAnalyser::harmonics_below_nyquist(double fundamental_hz) const noexcept {
    const double nyquist = bin_hz_ * static_cast<double>(last_bin_);
    std::size_t count = 0;
    while (count < max_harmonics && static_cast<double>(count + 1) * fundamental_hz <= nyquist) {
        ++count;
    }
    return count;
}

/// @param amplitude that of a line of magnitude 1
void SpectrumAnalyser::add_harmonics(SpectrumSummary& summary, double amplitude) const {
    const double fundamental = summary.fundamental_hz;
    std::vector<double> lines(harmonics_below_nyquist(fundamental));
    for (std::size_t k = 1; k <= lines.size(); ++k) {
        lines[k - 1] = line(static_cast<double>(k) * fundamental, neighbourhood * fundamental);
    }
    const double largest = lines.empty() ? 0.0 : std::ranges::max(lines);
    if (!(largest > 0)) {
        return;
    }
    double power = 0;
    for (const double magnitude : lines) {
        summary.harmonics.push_back(std::min(amplitude * magnitude, std::numeric_limits<double>::max()));
        summary.harmonics_db.push_back(decibels(magnitude / largest));
        power += magnitude * magnitude;
    }
    if (lines.size() > 1) {
        const double overtones = std::max(power - lines.front() * lines.front(), 0.0);
        summary.thd_r = std::sqrt(overtones / power);
        if (lines.front() > 0) {
            summary.thd_f = std::sqrt(overtones) / lines.front();
        }
    }
    summary.subharmonic_db = decibels(line(fundamental / 2, neighbourhood * fundamental) / largest);
}

std::vector<double> SpectrumAnalyser::harmonics(std::span<const double> record, double fundamental_hz) {
    require_fundamental(fundamental_hz);
    SpectrumSummary summary;
    summary.fundamental_hz = fundamental_hz;
    if (transform(record)) {
        add_harmonics(summary, amplitude_of_a_line(record.size()));
    } else if (peak_of(record) == 0) {
        summary.harmonics.assign(harmonics_below_nyquist(fundamental_hz), 0.0);
    }
    return std::move(summary.harmonics);
}

SpectrumSummary SpectrumAnalyser::analyse(std::span<const double> record, double fundamental_hz,
                                          std::optional<double> lowest_hz) {
    require_fundamental(fundamental_hz);
    SpectrumSummary summary;
    summary.fundamental_hz = fundamental_hz;
    summary.lowest_hz = lowest_hz.value_or(fundamental_hz / 2);
    if (!(summary.lowest_hz >= 0) || !std::isfinite(summary.lowest_hz)) {
        throw std::invalid_argument("a band begins at 0 Hz or above");
    }
    if (transform(record)) {
        add_bands(summary);
        add_harmonics(summary, amplitude_of_a_line(record.size()));
    }
    return summary;
}

MagnitudeSpectrum SpectrumAnalyser::magnitudes(std::span<const double> record) {
    const bool audible = transform(record);
    const std::size_t bins = last_bin_ + 1;
    MagnitudeSpectrum spectrum;
    spectrum.frequencies_hz.resize(bins);
    spectrum.amplitudes.resize(bins);
    for (std::size_t bin = 0; bin < bins; ++bin) {
        spectrum.frequencies_hz[bin] = bin_hz_ * static_cast<double>(bin);
        if (audible) {
            // a real tone splits into +f and -f; a constant does not
            spectrum.amplitudes[bin] =
                (bin == 0 ? 0.5 : 1.0) * amplitude_of_a_line(record.size()) * magnitude(bin);
        }
    }
    return spectrum;
}

}  // namespace hertzline
