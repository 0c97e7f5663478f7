#pragma once
// The spectrum of a record of an output: harmonics, sub-harmonic, distortion and bands, as the field reports them.
// docs/measures.md defines each number for users.
//
// One definition carries all of it: the magnitude of the Fourier sum of the whole record, without a window
// and without removing the mean, zero-padded at least fourfold. A line "at" f is the largest magnitude within
// a tenth of the fundamental of f, not the value at exactly f: a burst's lines are as wide as the burst is
// short and the chain shifts and splits them by a few hundred hertz, so that the value at exactly k f catches
// a slope or a notch (up to 1.5 dB too low on the paper's scenes), while the maximum is the value that one reads off a
// plot. It is also the definition that reproduces an independent analysis of these scenes to 0.1 dB. No
// window: a burst starts and ends at rest, so nothing leaks, and a window would weigh the quiet stretches
// against the strong ones.

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hertzline {

/// The frequencies at which a spectrum reaches a threshold.
struct Band {
    double low_hz = 0;       ///< the lowest
    double high_hz = 0;      ///< the highest
    double occupied_hz = 0;  ///< all of them together, without the holes between

    double width_hz() const noexcept { return high_hz - low_hz; }
    double centre_hz() const noexcept { return low_hz + width_hz() / 2; }
};

/// A value is absent where the record does not determine it: above half the sample rate, and everywhere when the
/// record is silent or contains a value that is not finite.
struct SpectrumSummary {
    double fundamental_hz = 0;
    double lowest_hz = 0;  ///< bands and the strongest frequency are looked for from here upward
    std::vector<double>
        harmonics;  ///< amplitudes V_k at k = 1, 2, ... up to ten or Nyquist, as in MagnitudeSpectrum
    std::vector<double> harmonics_db;      ///< the same [dB] relative to the largest of them
    std::optional<double> subharmonic_db;  ///< at f/2; [dB] relative to the largest harmonic
    /// sqrt(sum_{k>=2} V_k^2) / sqrt(sum_{k>=1} V_k^2), over the same; absent where there is one alone
    std::optional<double> thd_r;
    std::optional<double> thd_f;  ///< sqrt(sum_{k>=2} V_k^2) / V_1; absent where V_1 is 0, and as thd_r
    std::optional<double> strongest_hz;  ///< where the spectrum has its maximum from lowest_hz upward
    std::optional<double> dc_db;         ///< at 0 Hz; [dB] relative to that maximum
    std::optional<double>
        below_db;  ///< largest level below lowest_hz, 0 Hz included; [dB] relative to that maximum
    std::optional<Band> band_6db;   ///< at least 10^(-6/20) of that maximum, from lowest_hz upward
    std::optional<Band> band_20db;  ///< the same with 10^(-20/20)
};

/// Largest absolute value, 0 of nothing.
double peak_of(std::span<const double> values);

/// How much larger each line of a record is than the same line of another one [dB]; as many as both have.
std::vector<double> level_differences_db(std::span<const double> harmonics, std::span<const double> others);

/// Magnitudes over frequency, ready to be plotted.
struct MagnitudeSpectrum {
    std::vector<double> frequencies_hz;  ///< 0 to Nyquist, equally spaced
    std::vector<double> amplitudes;  ///< unit of the record; a sine that fills the record shows its amplitude
};

/// Spectra of records of one length and rate; the transform is planned once.
///
/// Several threads may each have their own: FFTW's planner, which is not thread safe, is asked by one at a time. No other code of the
/// process may plan with FFTW meanwhile. One analyser serves one thread at a time.
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

    /// The summary of a record. @param lowest_hz where bands begin; left out: half the fundamental
    /// @throws std::invalid_argument when the record is longer than the constructor's `samples`, the fundamental is
    /// not positive and finite, or lowest_hz negative or not finite.
    SpectrumSummary analyse(std::span<const double> record, double fundamental_hz,
                            std::optional<double> lowest_hz = std::nullopt);

    /// The summary's harmonics alone; zeros of a silent record. @throws as analyse() does.
    std::vector<double> harmonics(std::span<const double> record, double fundamental_hz);

    /// The spectrum itself: 2/n |sum v exp(-i omega t)|, and half of that at 0 Hz. A silent record gives
    /// zeros; one with a value that is not finite gives zeros too. @throws as analyse() does.
    MagnitudeSpectrum magnitudes(std::span<const double> record);

private:
    bool transform(std::span<const double> record);
    double amplitude_of_a_line(std::size_t samples) const noexcept {
        return scale_ * (2 / static_cast<double>(samples));
    }
    std::size_t harmonics_below_nyquist(double fundamental_hz) const noexcept;
    void add_harmonics(SpectrumSummary& summary, double amplitude) const;
    void add_bands(SpectrumSummary& summary) const;
    void take_powers() noexcept;
    double magnitude(std::size_t bin) const noexcept { return std::sqrt(powers_[bin]); }
    double magnitude_at(double frequency_hz) const noexcept;
    double line(double frequency_hz, double half_width_hz) const noexcept;
    std::optional<Band> band_above(double threshold, double lowest_hz) const noexcept;

    struct Transform;  // FFTW's types stay out of the header

    std::size_t samples_;
    std::size_t padded_ = 0;
    std::size_t last_bin_ = 0;  // at half the sample rate
    double bin_hz_ = 0;
    double scale_ = 0;  // largest |sample| of the record that was transformed last
    std::vector<double>
        buffer_;  // the padded record, then its transform in place: real and imaginary parts in turn
    std::vector<double>
        powers_;  // squared magnitudes of the bins 0 to last_bin_, of the record scaled to a peak of 1
    std::unique_ptr<Transform> transform_;
};

}  // namespace hertzline
