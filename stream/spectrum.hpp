#pragma once
// What a record of velocity holds, frequency by frequency: harmonics, sub-harmonic, distortion and
// bandwidths, as the field reports them of v_out.
//
// One definition carries all of it: the magnitude of the Fourier sum of the whole record, without a window
// and without removing the mean, zero-padded at least fourfold. A line "at" f is the largest magnitude within
// a tenth of the fundamental of f, not the value at exactly f: a burst's lines are as wide as the burst is
// short and the chain shifts and splits them by a few hundred hertz, so that the value at exactly k f catches
// a slope or a notch (up to 1.5 dB too low on the paper's scenes), while the maximum is what one reads off a
// plot. It is also the definition that reproduces an independent analysis of these scenes to 0.1 dB. No
// window: a burst starts and ends at rest, so nothing leaks, and a window would weigh the quiet stretches
// against the strong ones.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hertzline::stream {

/// A stretch of the frequency axis.
struct Band {
    double low_hz = 0;
    double high_hz = 0;
    double width_hz() const noexcept { return high_hz - low_hz; }
};

/// A value is absent where the record does not determine it: above half the sample rate, and everywhere when the
/// record is silent or contains a value that is not finite.
struct SpectrumSummary {
    double fundamental_hz = 0;
    std::vector<double> harmonics_db;  ///< k = 1, 2, ... up to ten or Nyquist; [dB] under the largest of them
    std::optional<double> subharmonic_db;  ///< at f/2; [dB] under the largest harmonic
    std::optional<double> thd_r;  ///< sqrt(sum_{k>=2} V_k^2) / sqrt(sum_{k>=1} V_k^2), over the same ten
    /// Lowest to highest frequency with at least 10^(-6/20) of the spectrum's maximum; 0 Hz counts like any other.
    std::optional<Band> band_6db;
    std::optional<Band> band_20db;  ///< the same with 10^(-20/20)
};

/// Magnitudes over frequency, ready to be plotted.
struct MagnitudeSpectrum {
    std::vector<double> frequencies_hz;  ///< 0 to Nyquist, equally spaced
    std::vector<double> amplitudes;  ///< unit of the record; a sine that fills the record shows its amplitude
};

/// Spectra of records of one length and rate; the transform is planned once.
///
/// FFTW's planner is not thread safe: construct and destroy analysers from one thread at a time, and not
/// while other code of the process plans with FFTW. One analyser serves one thread at a time.
class SpectrumAnalyser {
public:
    static constexpr std::size_t max_harmonics = 10;
    static constexpr double floor_db = -300;  ///< levels stop here: below is rounding, and log of nothing

    /// For records of up to `samples` at `sample_rate_hz`. Takes bytes_needed(samples) of memory.
    /// @throws std::invalid_argument when samples is 0 or too large for the transform (2^28), or the rate is
    /// not positive and finite; std::bad_alloc when there is no memory for it.
    SpectrumAnalyser(std::size_t samples, double sample_rate_hz);
    ~SpectrumAnalyser();
    SpectrumAnalyser(const SpectrumAnalyser&) = delete;
    SpectrumAnalyser& operator=(const SpectrumAnalyser&) = delete;

    /// Memory of an analyser for records of that many samples [bytes]; in double, so that any request
    /// can be judged.
    static double bytes_needed(double samples) noexcept;

    /// The summary of a record. @throws std::invalid_argument when the record is longer than the constructor
    /// was told, or the fundamental is not positive and finite.
    SpectrumSummary analyse(std::span<const double> record, double fundamental_hz);

    /// The spectrum itself: 2/n |sum v exp(-i omega t)|, and half of that at 0 Hz. A silent record gives
    /// zeros; one with a value that is not finite gives zeros too. @throws as analyse() does.
    MagnitudeSpectrum magnitudes(std::span<const double> record);

private:
    bool transform(std::span<const double> record);
    double magnitude(std::size_t bin) const noexcept;
    double line(double frequency_hz, double half_width_hz) const noexcept;
    Band band_above(double threshold) const noexcept;

    struct Transform;  // FFTW's types stay out of the header

    std::size_t samples_;
    std::size_t padded_ = 0;
    std::size_t last_bin_ = 0;  // at half the sample rate
    double bin_hz_ = 0;
    double scale_ = 0;  // largest |sample| of the record that was transformed last
    // The padded record, then its spectrum in place: bins 0 .. last_bin_, real and imaginary parts in turn.
    std::vector<double> buffer_;
    std::unique_ptr<Transform> transform_;
};

}  // namespace hertzline::stream
