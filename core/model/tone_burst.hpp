#pragma once
// The horn's prescribed motion x_h(t) = A e(t) sin(2 pi f t) as a function of time, burst after burst.
//
// The motion is smooth only piecewise: a burst consists of a rise, a flat top and a fall (hann: one piece;
// rectangular: the top alone), then silence. Integrators are handed one smooth piece at a time.

#include <array>
#include <cstddef>
#include <cstdint>

#include "hertzline/scene.hpp"

namespace hertzline {

/// Horn displacement [m], velocity [m/s], acceleration [m/s^2].
struct HornMotion {
    double x = 0;
    double v = 0;
    double a = 0;
};

/// The horn during one step of the integrator, every value taken from the smooth piece the step lies in.
struct HornStep {
    HornMotion start;
    HornMotion middle;
    HornMotion end;
    bool fresh = false;   ///< the horn's piece changed at this step's start: carried forces are stale
    bool breaks = false;  ///< the piece changes inside this step
};

/// A smooth piece of the motion as up to three sinusoids, sum of amplitude sin(2 pi (frequency t + phase))
/// with t since the burst's start, where a sweep adds to the frequencies: the carrier, and the two side bands that a raised cosine gives it.
struct SmoothDrive {
    std::array<double, 3> amplitude_m{};
    std::array<double, 3> phase_turns{};
    double since_burst_s = 0;  ///< t at the moment that was asked for
    double left_s = 0;         ///< from then until the piece ends; infinite after a last burst
};

/// The highest frequency of the tone [Hz]: at its start, or at the end of its sweep.
double highest_frequency_hz(const Drive& drive) noexcept;

/// Largest velocity of the horn, 2 pi f A [m/s]; 0 where there is none.
double largest_velocity(const Drive& drive) noexcept;

/// The horn's displacement and velocity as functions of time.
class ToneBurst {
public:
    /// @param step_s the integrator's step: times are step counts, so that they neither drift nor accumulate.
    ToneBurst(const Drive& drive, double step_s);

    /// Exact motion at time (step + fraction) h on the piece that holds (step + on_piece) h.
    HornMotion at(std::int64_t step, double fraction, double on_piece) const noexcept;
    HornMotion at(std::int64_t step, double fraction) const noexcept { return at(step, fraction, fraction); }

    /// Frequencies of the sinusoids of every SmoothDrive at the start of a burst [Hz].
    std::array<double, 3> frequencies_hz() const noexcept;
    /// By how much they all change in a second [Hz/s]: 0 but for sweeps.
    double sweep_hz_per_s() const noexcept { return sweep_hz_per_s_; }

    /// The piece that begins or continues at (step + fraction) h.
    SmoothDrive smooth(std::int64_t step, double fraction) const noexcept;

    /// Fraction of the step at which the next piece begins, looking from `after`; >= 1 when none does in this step.
    double next_break(std::int64_t step, double after) const noexcept;

    /// The motion over `count` steps from `first`. Batches should start at multiples of batch_steps, so that the
    /// bits do not depend on how a run is cut into blocks. @returns whether the horn rests in all of them.
    bool fill(std::int64_t first, HornStep* steps, int count) noexcept;

    static constexpr int batch_steps = 64;

private:
    struct Place {
        std::int64_t burst;
        int piece;     ///< -1 before the burst, 0 rise, 1 top, 2 fall, 3 silence
        double local;  ///< time since the burst's start [s]
        bool operator==(const Place& o) const noexcept { return burst == o.burst && piece == o.piece; }
    };
    double since_burst(std::int64_t step, double fraction, std::int64_t burst) const noexcept;
    Place place(std::int64_t step, double fraction) const noexcept;
    double piece_end(int piece) const noexcept;
    HornMotion motion(int piece, double local) const noexcept;
    void fill_tables() noexcept;
    void fill_smooth(const Place& start, HornStep* steps, int count) noexcept;
    void fill_piecewise(std::int64_t first, HornStep* steps, int count) const noexcept;

    double step_;
    double amplitude_;
    double omega_;  ///< carrier 2 pi f [rad/s]
    double sweep_hz_per_s_;
    double start_;           ///< of the first burst [s]
    double duration_;        ///< of a burst [s]
    double rise_ = 0;        ///< of the envelope [s]; 0 for rectangular, the whole burst for hann
    double ramp_omega_ = 0;  ///< the envelope's angular frequency [rad/s]
    double repetition_hz_;
    bool hann_;
    // cos and sin of carrier and envelope at multiples of half a step, so that a batch needs four calls of sin; filled for the first
    static constexpr std::size_t table_size = 2 * batch_steps + 1;
    std::array<double, table_size> carrier_cos_{}, carrier_sin_{}, ramp_cos_{}, ramp_sin_{};
    bool has_tables_ = false;
};

}  // namespace hertzline
