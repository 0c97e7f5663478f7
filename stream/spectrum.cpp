#include "stream/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
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
std::optional<double> peak_of(std::span<const double> record) {
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

struct SpectrumAnalyser::Transform {
    explicit Transform(fftw_plan made) : plan(made) {
        if (plan == nullptr) {
            throw std::bad_alloc();
        }
    }
    ~Transform() { fftw_destroy_plan(plan); }
    Transform(const Transform&) = delete;
    Transform& operator=(const Transform&) = delete;

    fftw_plan plan;
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
    // FFTW_ESTIMATE: the plan depends on the size alone, so the same record gives the same bits in every run. The halfcomplex format is
    // planned a dozen times as fast as FFTW's r2c.
    transform_ = std::make_unique<Transform>(fftw_plan_r2r_1d(static_cast<int>(padded_), buffer_.data(),
                                                              buffer_.data(), FFTW_R2HC, FFTW_ESTIMATE));
}

SpectrumAnalyser::~SpectrumAnalyser() = default;

double SpectrumAnalyser::bytes_needed(double samples) noexcept {
    // The padded record in place and, while it is transformed, somewhat more than that for FFTW: 2.2 times were seen.
    return 2.5 * static_cast<double>(padding) * sizeof(double) * samples;
}

/// True when there is a spectrum: the record is finite and not silent. It is transformed scaled to a peak of
/// 1, so that no magnitude over- or underflows; ratios do not care, magnitudes() multiplies back.
bool SpectrumAnalyser::transform(std::span<const double> record) {
    if (record.size() > samples_) {
        throw std::invalid_argument("the record is longer than the spectrum was planned for");
    }
    const std::optional<double> peak = peak_of(record);
    if (!peak || *peak == 0) {
        return false;
    }
    scale_ = *peak;
    const auto end = std::ranges::transform(record, buffer_.begin(), [&](double v) { return v / *peak; }).out;
    std::fill(end, buffer_.end(), 0.0);
    fftw_execute(transform_->plan);
    return true;
}

double SpectrumAnalyser::magnitude(std::size_t bin) const noexcept {
    const bool is_real = bin == 0 || 2 * bin == padded_;
    return std::hypot(buffer_[bin], is_real ? 0 : buffer_[padded_ - bin]);
}

/// Largest magnitude within half_width_hz of frequency_hz, between the bins too.
double SpectrumAnalyser::line(double frequency_hz, double half_width_hz) const noexcept {
    const auto last = static_cast<double>(last_bin_);
    const double nearest = std::min(std::round(frequency_hz / bin_hz_), last);
    const double low = std::min(std::ceil((frequency_hz - half_width_hz) / bin_hz_), nearest);
    const double high = std::clamp(std::floor((frequency_hz + half_width_hz) / bin_hz_), nearest, last);
    auto top = static_cast<std::size_t>(low);
    for (std::size_t bin = top; bin <= static_cast<std::size_t>(high); ++bin) {
        if (magnitude(bin) > magnitude(top)) {
            top = bin;
        }
    }
    const double middle = magnitude(top);
    if (top == 0 || top == last_bin_ || magnitude(top - 1) > middle || magnitude(top + 1) > middle) {
        return middle;  // on the slope of something that is larger outside
    }
    return parabola_top(magnitude(top - 1), middle, magnitude(top + 1));
}

/// The outermost crossings of the threshold, straight lines drawn between the bins.
Band SpectrumAnalyser::band_above(double threshold) const noexcept {
    const auto crossing = [&](std::size_t outside, std::size_t inside) {
        const double below = magnitude(outside);
        const double above = magnitude(inside);
        const double part = above > below ? (threshold - below) / (above - below) : 1.0;
        const auto from = static_cast<double>(outside);
        return bin_hz_ * (from + part * (static_cast<double>(inside) - from));
    };
    std::size_t low = 0;
    while (low < last_bin_ && magnitude(low) < threshold) {
        ++low;
    }
    std::size_t high = last_bin_;
    while (high > low && magnitude(high) < threshold) {
        --high;
    }
    return {.low_hz = low == 0 ? 0.0 : crossing(low - 1, low),
            .high_hz = high == last_bin_ ? bin_hz_ * static_cast<double>(high) : crossing(high + 1, high)};
}

SpectrumSummary SpectrumAnalyser::analyse(std::span<const double> record, double fundamental_hz) {
    if (!(fundamental_hz > 0) || !std::isfinite(fundamental_hz)) {
        throw std::invalid_argument("a spectrum needs a positive fundamental frequency");
    }
    SpectrumSummary summary;
    summary.fundamental_hz = fundamental_hz;
    if (!transform(record)) {
        return summary;
    }
    double maximum = 0;
    for (std::size_t bin = 0; bin <= last_bin_; ++bin) {
        maximum = std::max(maximum, magnitude(bin));
    }
    summary.band_6db = band_above(maximum * std::pow(10.0, -6.0 / 20));
    summary.band_20db = band_above(maximum * std::pow(10.0, -20.0 / 20));

    const double nyquist = bin_hz_ * static_cast<double>(last_bin_);
    std::vector<double> lines;
    for (std::size_t k = 1; k <= max_harmonics && static_cast<double>(k) * fundamental_hz <= nyquist; ++k) {
        lines.push_back(line(static_cast<double>(k) * fundamental_hz, neighbourhood * fundamental_hz));
    }
    const double largest = lines.empty() ? 0.0 : std::ranges::max(lines);
    if (!(largest > 0)) {
        return summary;
    }
    double power = 0;
    for (const double amplitude : lines) {
        summary.harmonics_db.push_back(decibels(amplitude / largest));
        power += amplitude * amplitude;
    }
    const double overtones = std::max(power - lines.front() * lines.front(), 0.0);
    summary.thd_r = std::sqrt(overtones / power);
    summary.subharmonic_db = decibels(line(fundamental_hz / 2, neighbourhood * fundamental_hz) / largest);
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
            const double sides =
                bin == 0 ? 1.0 : 2.0;  // a real tone splits into +f and -f; a constant does not
            spectrum.amplitudes[bin] = sides * scale_ * (magnitude(bin) / static_cast<double>(record.size()));
        }
    }
    return spectrum;
}

}  // namespace hertzline::stream
