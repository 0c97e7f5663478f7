#pragma once
// A scene simulated for a while to measure the error of a step: pilots with different steps are compared.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/model/chain.hpp"
#include "core/step_choice/seen_motion.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline {

/// Samples that are compared at a time.
inline constexpr std::size_t pilot_block = 256;
/// The same where the steps that they take are counted, which may be many.
inline constexpr std::size_t counted_block = 16;

/// Steps times bodies that a simulation may take before the run: about a second of a series, less of other methods.
inline constexpr double affordable_body_steps = 1e7;

/// The scene with that method and step.
Scene with_step(Scene scene, Integrator integrator, double step_s);

/// The scene without a tolerance of rest: motion that sleep cuts off is no error of the step.
Scene without_sleep(Scene scene);

/// The scene with another fit of a modal plate's response, about as good as any: the motions' difference shows the effect of a fit's
/// error, which may be far larger than that error. The same scene where there is no such fit.
/// @param accuracy a third of which its error may be, where none has as small a one as the scene's @param other 0 or 1: one of two such fits
Scene with_another_fit(Scene scene, double accuracy, std::size_t other = 0);

/// The scene with no more points than pilots can afford to judge: a part of them, evenly spread.
Scene with_few_points(Scene scene);

/// An output as a velocity: its values times this [m/s]. The pressure of a plane wave with the velocity v is rho c v.
double velocity_per_unit(Tap tap, const EndModel& end) noexcept;

/// A simulation whose velocities are kept: those of all spheres, and with a plate those of the plate and the outputs.
class Pilot {
public:
    /// One that takes far too many steps fails. @param stop as of SimulationOptions: a pilot that was stopped has failed
    /// @throws std::bad_alloc
    Pilot(const Scene& scene, Integrator integrator, double step_s, const std::atomic<bool>* stop);

    /// Continues to that number of samples, until the integration fails, or until it has taken so many steps times bodies in all.
    /// @throws std::bad_alloc
    void run_to(std::size_t samples, double most_body_steps = std::numeric_limits<double>::infinity());

    bool stable() const noexcept { return stable_; }
    std::size_t samples() const noexcept { return velocities_.size() / columns_; }
    double sample_rate_hz() const noexcept { return simulation_.scene().output.sample_rate_hz; }
    std::int64_t steps() const { return simulation_.steps(); }
    /// Largest overlap of each contact so far [m].
    Eigen::ArrayXd peak_overlap() { return simulation_.state().peak_overlap; }

    /// The motion that it has seen so far. @param error estimated, of its step
    SeenMotion seen(double error) { return seen_motion(simulation_.extremes(), event_rate_, error); }

    std::size_t spheres() const noexcept { return spheres_; }
    /// Of a modal plate's response; nothing without one.
    std::optional<std::int64_t> poles() const noexcept { return simulation_.scene().numerics.poles; }
    std::size_t columns() const noexcept { return columns_; }
    /// Whether it has the paper's plate, whose output jumps.
    bool has_plate() const noexcept { return simulation_.chain().end.has_plate; }
    /// The velocities at a sample [m/s]: the spheres', the plate's, the outputs.
    const double* row(std::size_t sample) const noexcept { return velocities_.data() + sample * columns_; }

private:
    struct Output {
        Tap tap;
        std::size_t channels;
        double scale;  ///< to a velocity
    };

    Simulation simulation_;
    Samples block_;
    std::vector<Output> outputs_;
    std::size_t spheres_;
    std::size_t columns_;
    std::vector<double> velocities_;  // [sample][column]
    EventRate event_rate_;
    bool stable_ = true;
};

/// How two pilots differ: relative L2, infinite if one of them failed.
struct Difference {
    double of_any = 0;     ///< the column where it is largest
    double of_output = 0;  ///< the same of v_last and the outputs of the plate
    double loudness =
        0;  ///< L2 norm of v_out, or the scale that it is judged on if it is quiet [m/s]; 0 without a plate
};

/// Over the first samples. A column below quiet_column of the loudest is judged on that scale. @throws std::bad_alloc
/// @param of samples over which the columns' L2 norms are taken, `samples` at least; the more there are, the less the error can be
Difference difference(const Pilot& pilot, const Pilot& better, std::size_t samples, std::size_t of);
inline Difference difference(const Pilot& pilot, const Pilot& better, std::size_t samples) {
    return difference(pilot, better, samples, samples);
}

/// Samples of v_out that fall on the wrong side of a switching of the last contact. v_out jumps there, and the pilots'
/// difference in position decides on the side.
struct WrongSides {
    double count = 0;  ///< to be expected
    double norm = 0;   ///< L2 norm of their expected errors [m/s]
};

/// Over the first samples of two pilots that have not failed. @param jump least jump of v_out that counts [m/s]
WrongSides wrong_sides(const Pilot& pilot, const Pilot& better, std::size_t samples, double jump) noexcept;

/// A column's L2 norm over that of the loudest column, below which its relative error says nothing.
inline constexpr double quiet_column = 1e-6;

}  // namespace hertzline
