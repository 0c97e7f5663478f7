#pragma once
// Chooses the integrator and the step that a scene leaves open, by measuring instead of guessing.
//
// A pilot runs the scene over its burst and until it has rung down. One runs as exactly as can be had, as a reference
// (reference_pilot.hpp); how far another one is from it is the error of its step. Pilots together cost about as much as simulating a
// few milliseconds. The contacts' largest overlaps in them give the largest stable step.

#include <atomic>
#include <optional>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/step_choice/step_advice.hpp"

namespace hertzline {

/// Why a scene gets its integrator.
enum class IntegratorReason {
    set_by_scene,
    fastest,  ///< a series of order 8: the fastest for its error, however long the chain (bench_crossover)
    high_accuracy,  ///< an accuracy below high_accuracy: a series of order 12
};

/// A wanted error below this gets order 12.
inline constexpr double high_accuracy = 1e-6;

/// An integrator and the reason for it.
struct IntegratorChoice {
    Integrator integrator;
    IntegratorReason reason;
};
IntegratorChoice integrator_choice(const Scene& scene) noexcept;

/// The scene with its integrator set.
Scene with_integrator(Scene scene);

/// The scene with the poles of its modal plate settled, if it has one. @throws std::bad_alloc
Scene with_poles(Scene scene);
/// Error of the fit with these poles, relative to the plate's response in the band; 0 without a modal plate. @throws std::bad_alloc
double pole_error(const Scene& scene);

/// Advice for a valid scene. Independent of output.duration_s, so that runs of any length agree bit for bit.
/// Aims at numerics.accuracy or default_accuracy. @throws std::bad_alloc
StepAdvice advise_step(const Scene& scene);

/// A scene with integrator and step, and the error to be expected of them; or the scene's faults.
struct Resolution {
    /// For a Simulation. @throws std::invalid_argument with every fault, a line each
    operator ResolvedScene() const;

    Scene scene;  ///< without faults: numerics.integrator and step_s set, accuracy unset
    IntegratorReason integrator_reason = IntegratorReason::set_by_scene;
    bool step_set_by_scene = false;
    StepAdvice advice;
    int pilots = 0;  ///< all that ran: the reference, those of the advice, that of the step in use
    /// Error of the step in use: the difference of a pilot at that step from the reference, over the first 500 spheres. For a run that
    /// is longer than pilots watch, the difference from a run with shorter steps if that is larger. None if the pilot would take too
    /// long, or fails.
    std::optional<ErrorEstimate> estimate;
    std::optional<double> run_s;  ///< over which the error was to be estimated
    SeenMotion seen;              ///< by the pilot of the estimate, if there is one
    double steps_per_burst = 0;   ///< to be expected: steps, or pieces of a series
    std::vector<Fault> faults;    ///< of the values, the step, the plate or the rest tolerance

    /// Whether the accuracy asked for, or the default, is missed by the estimate. A scene that gives its step asks for none.
    bool misses_accuracy() const noexcept {
        return !step_set_by_scene && !(estimate && estimate->error <= advice.accuracy);
    }
    /// Whether the estimate says nothing about the end of the run: a small error may grow.
    bool estimate_ends_early() const noexcept {
        return estimate && run_s && estimate->over_s < *run_s - 1 / scene.output.sample_rate_hz;
    }
    /// Whether the accuracy is kept as far as is known, but the run is longer.
    bool may_miss_accuracy() const noexcept {
        return !step_set_by_scene && !misses_accuracy() && estimate_ends_early();
    }
};

/// @param run_s how long the run is over which the error is estimated [s]; none: as long as the pilots watch
/// @param stop ends the estimate of a long run within a few steps: it then ends early. @throws std::bad_alloc
Resolution resolve(const Scene& scene, std::optional<double> run_s, const std::atomic<bool>* stop = nullptr);
/// Over output.duration_s.
Resolution resolve(const Scene& scene, const std::atomic<bool>* stop = nullptr);

}  // namespace hertzline
