#pragma once
// The horn's prescribed motion x_h(t), whatever makes it. The motion is smooth only piecewise, and integrators are handed one smooth
// piece at a time.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "hertzline/scene.hpp"

namespace hertzline {

class PiecewiseMotion;

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

/// A stretch of a sampled motion: x = sum of terms[k] u^k with u = (t - middle)/half, t since the record's first sample [s].
struct Polynomial {
    static constexpr std::size_t count = 16;
    double middle_s = 0;
    double half_s = 1;
    double end_s = std::numeric_limits<double>::infinity();
    std::array<double, count> terms{};  ///< [m]

    HornMotion at(double time_s) const noexcept;
    bool silent() const noexcept { return terms == std::array<double, count>{}; }
};

/// A smooth piece of the motion: a polynomial, or up to three sinusoids, sum of amplitude sin(2 pi (frequency t + phase))
/// with t since the burst's start, where a sweep adds to the frequencies: the carrier, and the two side bands that a raised cosine
/// gives it.
struct SmoothDrive {
    std::array<double, 3> amplitude_m{};
    std::array<double, 3> phase_turns{};
    const Polynomial* polynomial = nullptr;
    double since_burst_s = 0;  ///< t at the moment that was asked for
    double left_s = std::numeric_limits<
        double>::infinity();  ///< from then until the piece ends; infinite after a last burst

    bool silent() const noexcept {
        return polynomial != nullptr ? polynomial->silent() : amplitude_m[0] == 0;
    }
};

/// The start of each burst: start_s after every multiple of the period, or of time 0 where there is but one. Times are step counts, so
/// that they neither drift nor accumulate.
class BurstClock {
public:
    BurstClock(double step_s, double start_s, double repetition_hz) noexcept
        : step_(step_s), start_(start_s), repetition_hz_(repetition_hz) {}

    double step_s() const noexcept { return step_; }
    /// Time at (step + fraction) h since the start of a burst [s]; negative before it.
    double since(std::int64_t step, double fraction, std::int64_t burst) const noexcept;
    /// The burst in whose period that time lies.
    std::int64_t burst_at(std::int64_t step, double fraction) const noexcept;
    /// From one burst's start to the next [s]; infinite where there is but one.
    double period_s() const noexcept {
        return repetition_hz_ > 0 ? 1 / repetition_hz_ : std::numeric_limits<double>::infinity();
    }

private:
    double step_;
    double start_;
    double repetition_hz_;
};

/// The horn's displacement and velocity as functions of time, counted in steps of the integrator.
class Horn {
public:
    virtual ~Horn() = default;

    /// Exact motion at time (step + fraction) h on the piece that holds (step + on_piece) h.
    virtual HornMotion at(std::int64_t step, double fraction, double on_piece) const noexcept = 0;
    HornMotion at(std::int64_t step, double fraction) const noexcept { return at(step, fraction, fraction); }

    /// Fraction of the step at which the next piece begins, looking from `after`; >= 1 when none does in this step.
    virtual double next_break(std::int64_t step, double after) const noexcept = 0;

    /// The motion over `count` steps from `first`. Batches should start at multiples of batch_steps, so that the
    /// bits do not depend on how a run is cut into blocks. @returns whether the horn rests in all of them.
    virtual bool fill(std::int64_t first, HornStep* steps, int count) noexcept = 0;

    static constexpr int batch_steps = 64;

    /// The motion at the starts of batch_steps steps from `first`; where it jumps, that of the piece which begins there.
    virtual void at_starts(std::int64_t first, HornMotion* motion) noexcept;

    /// The piece that begins or continues at (step + fraction) h.
    virtual SmoothDrive smooth(std::int64_t step, double fraction) const noexcept = 0;

    /// Frequencies of the sinusoids of every SmoothDrive at the start of a burst [Hz]; 0 of polynomials.
    virtual std::array<double, 3> frequencies_hz() const noexcept { return {}; }
    /// Whether the motion is no sum of sinusoids, and solvers take its series().
    virtual bool has_series() const noexcept { return true; }
    /// Coefficients of the motion about a moment of the piece [m]: of z^n, where z = 1 stands for a time unit.
    /// @param since_look_up from the moment that the piece was asked for [s]
    virtual void series(const SmoothDrive& piece, double since_look_up, double unit_s,
                        std::span<double> terms) const noexcept = 0;
};

/// The horn of a scene. @param step_s the integrator's step @param live the motion of a live drive, unless the scene has its samples
/// @throws std::invalid_argument where samples are missing
std::unique_ptr<Horn> make_horn(const Drive& drive, double step_s,
                                std::shared_ptr<const PiecewiseMotion> live = nullptr);

}  // namespace hertzline
