#include "stream/measures/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>

#include <fftw3.h>

namespace hertzline::stream {
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
    double peak = 0;
    for (const double v : record) {
        if (!std::isfinite(v)) {
            return std::nullopt;
        }
        peak = std::max(peak, std::abs(v));
    }
    return peak;
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

}  // namespace

double peak_of(std::span<const double> values) {
    double peak = 0;
    for (const double value : values) {
        peak = std::max(peak, std::abs(value));
    }
    return peak;
}

std::vector<double> level_differences_db(std::span<const double> harmonics, std::span<const double> others) {
    std::vector<double> differences;
    for (std::size_t k = 0; k < std::min(harmonics.size(), others.size()); ++k) {
        const double ratio = others[k] > 0 ? harmonics[k] / others[k] : std::numeric_limits<double>::max();
        differences.push_back(std::min(decibels(ratio), -SpectrumAnalyser::floor_db));
    }
    return differences;
}

struct SpectrumAnalyser::Transform {
    /// FFTW_ESTIMATE: the plan depends on the size alone, so the same record gives the same bits in every run. The halfcomplex format is
    /// planned a dozen times as fast as FFTW's r2c.
    Transform(std::size_t size, double* values) {
        const std::scoped_lock lock(planner);
        plan = fftw_plan_r2r_1d(static_cast<int>(size), values, values, FFTW_R2HC, FFTW_ESTIMATE);
        if (plan == nullptr) {
            throw std::bad_alloc();
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
    magnitudes_.resize(last_bin_ + 1);
    transform_ = std::make_unique<Transform>(padded_, buffer_.data());
}

SpectrumAnalyser::~SpectrumAnalyser() = default;

double SpectrumAnalyser::bytes_needed(double samples) noexcept {
    // The padded record in place, the magnitudes and, while it is transformed, somewhat more than the record for FFTW: 2.7 times were seen.
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
    const auto end = std::ranges::transform(record, buffer_.begin(), [&](double v) { return v / *peak; }).out;
    std::fill(end, buffer_.end(), 0.0);
    fftw_execute(transform_->plan);
    magnitudes_[0] = std::abs(buffer_[0]);
    for (std::size_t bin = 1; bin < last_bin_; ++bin) {
        const double real = buffer_[bin];
        const double imaginary = buffer_[padded_ - bin];
        magnitudes_[bin] = std::sqrt(real * real + imaginary * imaginary);
    }
    magnitudes_[last_bin_] = std::abs(buffer_[last_bin_]);
    return true;
}

/// Straight lines are drawn between the bins. @param frequency_hz from 0 to half the sample rate
double SpectrumAnalyser::magnitude_at(double frequency_hz) const noexcept {
    const double bin = std::min(frequency_hz / bin_hz_, static_cast<double>(last_bin_));
    const auto left = static_cast<std::size_t>(bin);
    const std::size_t right = std::min(left + 1, last_bin_);
    return std::lerp(magnitudes_[left], magnitudes_[right], bin - static_cast<double>(left));
}

/// Largest magnitude within half_width_hz of frequency_hz, between the bins too.
double SpectrumAnalyser::line(double frequency_hz, double half_width_hz) const noexcept {
    const auto last = static_cast<double>(last_bin_);
    const double nearest = std::min(std::round(frequency_hz / bin_hz_), last);
    const double low = std::min(std::ceil((frequency_hz - half_width_hz) / bin_hz_), nearest);
    const double high = std::clamp(std::floor((frequency_hz + half_width_hz) / bin_hz_), nearest, last);
    auto top = static_cast<std::size_t>(low);
    for (std::size_t bin = top; bin <= static_cast<std::size_t>(high); ++bin) {
        if (magnitudes_[bin] > magnitudes_[top]) {
            top = bin;
        }
    }
    const double middle = magnitudes_[top];
    if (top == 0 || top == last_bin_ || magnitudes_[top - 1] > middle || magnitudes_[top + 1] > middle) {
        return middle;  // on the slope of something that is larger outside
    }
    return parabola_top(magnitudes_[top - 1], middle, magnitudes_[top + 1]);
}

/// Where the magnitudes, with straight lines between the bins, reach the threshold.
std::optional<Band> SpectrumAnalyser::band_above(double threshold, double lowest_hz) const noexcept {
    std::optional<Band> band;
    double left_hz = lowest_hz;
    double left = magnitude_at(lowest_hz);
    const auto first = static_cast<std::size_t>(lowest_hz / bin_hz_) + 1;
    for (std::size_t bin = first; bin <= last_bin_; ++bin) {
        const double right_hz = bin_hz_ * static_cast<double>(bin);
        const double right = magnitudes_[bin];
        if (std::max(left, right) >= threshold) {
            const double crossing = left_hz + (right_hz - left_hz) * (threshold - left) / (right - left);
            const double from = left >= threshold ? left_hz : crossing;
            const double to = right >= threshold ? right_hz : crossing;
            band = {.low_hz = band ? band->low_hz : from,
                    .high_hz = to,
                    .occupied_hz = (band ? band->occupied_hz : 0) + (to - from)};
        }
        left_hz = right_hz;
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
    double maximum = magnitude_at(summary.lowest_hz);
    summary.strongest_hz = summary.lowest_hz;
    double below = magnitudes_[0];
    for (std::size_t bin = 0; bin <= last_bin_; ++bin) {
        const double frequency = bin_hz_ * static_cast<double>(bin);
        if (frequency < summary.lowest_hz) {
            below = std::max(below, magnitudes_[bin]);
        } else if (magnitudes_[bin] > maximum) {
            maximum = magnitudes_[bin];
            summary.strongest_hz = frequency;
        }
    }
    if (!(maximum > 0)) {
        summary.strongest_hz = std::nullopt;
        return;
    }
    summary.dc_db = decibels(magnitudes_[0] / maximum);
    summary.below_db = decibels(below / maximum);
    summary.band_6db = band_above(maximum * std::pow(10.0, -6.0 / 20), summary.lowest_hz);
    summary.band_20db = band_above(maximum * std::pow(10.0, -20.0 / 20), summary.lowest_hz);
}

/// @param amplitude that of a line of magnitude 1
void SpectrumAnalyser::add_harmonics(SpectrumSummary& summary, double amplitude) const {
    const double fundamental = summary.fundamental_hz;
    const double nyquist = bin_hz_ * static_cast<double>(last_bin_);
    std::vector<double> lines;
    for (std::size_t k = 1; k <= max_harmonics && static_cast<double>(k) * fundamental <= nyquist; ++k) {
        lines.push_back(line(static_cast<double>(k) * fundamental, neighbourhood * fundamental));
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
    const double overtones = std::max(power - lines.front() * lines.front(), 0.0);
    summary.thd_r = std::sqrt(overtones / power);
    if (lines.front() > 0) {
        summary.thd_f = std::sqrt(overtones) / lines.front();
    }
    summary.subharmonic_db = decibels(line(fundamental / 2, neighbourhood * fundamental) / largest);
}

SpectrumSummary SpectrumAnalyser::analyse(std::span<const double> record, double fundamental_hz,
                                          std::optional<double> lowest_hz) {
    if (!(fundamental_hz > 0) || !std::isfinite(fundamental_hz)) {
        throw std::invalid_argument("a spectrum needs a positive fundamental frequency");
    }
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
                (bin == 0 ? 0.5 : 1.0) * amplitude_of_a_line(record.size()) * magnitudes_[bin];
        }
    }
    return spectrum;
}

}  // namespace hertzline::stream
