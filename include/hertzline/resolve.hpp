#pragma once
// Chooses the integrator and the step that a scene leaves open, by measuring instead of guessing.
//
// A pilot runs the scene over its burst and until it has rung down. The reference runs as exactly as possible; the difference of
// another pilot from it is the error of that pilot's step. Pilots together cost about as much as simulating a few milliseconds. The
// contacts' largest overlaps in them give the largest stable step. core/README.md explains the choice.

#include <atomic>
#include <optional>
#include <vector>

#include "hertzline/scene.hpp"

namespace hertzline {

/// Why a scene gets its integrator.
enum class IntegratorReason {
    set_by_scene,
    fastest,  ///< a series of order 8: the fastest for its error, however long the chain (bench_crossover)
    high_accuracy,  ///< an accuracy below 1e-6: a series of order 12
};

/// An error and the stretch from the start over which it was found.
struct ErrorEstimate {
    double error = 0;        ///< relative L2 of the worst of v_last and the outputs of the plate
    double over_s = 0;       ///< [s]
    bool amplifies = false;  ///< the motion amplifies rounding errors: no step brings the error down to them
    double of_fit =
        0;  ///< part of it that no step changes: by how much fits of a modal plate's response differ
};

/// Returns the larger error, with its stretch; an unknown one is the worst.
inline std::optional<ErrorEstimate> worse_of(const std::optional<ErrorEstimate>& a,
                                             const std::optional<ErrorEstimate>& b) noexcept {
    return !a || (b && a->error >= b->error) ? a : b;
}

/// Results of the pilots of a scene. A step is the longest piece of a series, or the step of a grid.
struct StepAdvice {
    double accuracy = default_accuracy;  ///< the wanted one: numerics.accuracy or the default
    double recommended_step_s = 0;       ///< meets the accuracy; of a grid: fits that of the samples
    double estimated_error = 0;          ///< relative L2, of the worst velocity at that step
    double largest_stable_step_s = 0;    ///< with the largest overlaps of the pilots
    bool accuracy_met = true;            ///< false: not even the smallest step tried can be shown to
    int pilots = 0;                      ///< number of pilot runs that it took, in addition to the reference
    double pilot_duration_s = 0;         ///< simulated time that each pilot covers [s]
};

/// The motion that pilots have seen.
struct SeenMotion {
    double largest_press_m = 0;  ///< as in MotionExtremes
    double last_press_m = 0;
    double events_per_s = 0;     ///< contact events, the largest rate of any burst
    double energy_residual = 0;  ///< the largest that is in keeping with the estimated error
};

/// A scene with integrator and step, and the error to be expected of them; or the scene's faults.
struct Resolution {
    /// For a Simulation. @throws std::invalid_argument with every fault, a line each
    operator ResolvedScene() const;

    Scene scene;     ///< without faults: numerics.integrator and step_s set, accuracy unset
    Numerics asked;  ///< as the scene gave them
    IntegratorReason integrator_reason = IntegratorReason::set_by_scene;
    bool step_set_by_scene = false;
    StepAdvice advice;
    int pilots = 0;  ///< all that ran: the reference, those of the advice, that of the step in use
    double pilot_body_steps =
        0;  ///< that they took, times spheres and end: a million or two take a tenth of a second
    /// Error of the step in use: the difference of a pilot at that step from the reference, over the first 500 spheres. For a run that
    /// is longer than pilots watch, the difference from a run with shorter steps if that is larger. None if the pilot would take too
    /// long, or fails.
    std::optional<ErrorEstimate> estimate;
    std::optional<double> run_s;  ///< over which the error was to be estimated
    SeenMotion seen;              ///< by the pilot of the estimate, if there is one
    double steps_per_burst = 0;   ///< to be expected: steps, or pieces of a series
    std::vector<Fault> faults;    ///< of the values, the step, the plate or the rest tolerance

    /// The scene with the numerics as it gave them.
    Scene requested() const;
    /// Whether the accuracy asked for, or the default, is missed by the estimate. A scene that gives its step asks for none; but it
    /// misses one where the motion amplifies rounding errors, or the error is that of another motion.
    bool misses_accuracy() const noexcept { return misses_accuracy(estimate); }
    /// The same of a later estimate.
    bool misses_accuracy(const std::optional<ErrorEstimate>& found) const noexcept {
        constexpr double of_another_motion = 0.05;
        if (step_set_by_scene) {
            return found && !(found->error <= (found->amplifies ? advice.accuracy : of_another_motion));
        }
        return !(found && found->error <= advice.accuracy);
    }
    /// Whether the estimate says nothing about the end of the run: a small error may grow.
    bool estimate_ends_early() const noexcept {
        return estimate && run_s && estimate->over_s < *run_s - 1 / scene.output.sample_rate_hz;
    }
    /// Whether the accuracy is kept as far as is known, but the run is longer.
    bool may_miss_accuracy() const noexcept { return !misses_accuracy() && estimate_ends_early(); }
};

/// @param run_s how long the run is over which the error is estimated [s]; unset: as long as the pilots watch
/// @param stop ends the estimate of a long run within a few steps: it then ends early
/// @param threads as of SimulationOptions. @throws std::bad_alloc @throws std::invalid_argument where run_s is not a positive number
Resolution resolve(const Scene& scene, std::optional<double> run_s, const std::atomic<bool>* stop = nullptr,
                   std::size_t threads = 1);
/// Over output.duration_s.
Resolution resolve(const Scene& scene);

}  // namespace hertzline
