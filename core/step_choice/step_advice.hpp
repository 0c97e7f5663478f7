#pragma once
// The integrator and the step of a scene that leaves them open. Pilots run with several steps, and their errors are measured.

#include "core/step_choice/reference_pilot.hpp"
#include "hertzline/resolve.hpp"

namespace hertzline {

/// An error that shorter steps do not bring below this is no truncation error: the motion is chaotic.
inline constexpr double chaotic_error = 0.05;

/// A wanted error below this gets order 12.
inline constexpr double high_accuracy = 1e-6;

/// An integrator and the reason for it.
struct IntegratorChoice {
    Integrator integrator;
    IntegratorReason reason;
};
IntegratorChoice integrator_choice(const Scene& scene) noexcept;

/// The accuracy to aim at: numerics.accuracy or default_accuracy.
double asked_accuracy(const Numerics& numerics) noexcept;

/// The scene with its integrator set.
Scene with_integrator(Scene scene);

/// The scene with the poles of its modal plate settled, if it has one. @throws std::bad_alloc
Scene with_poles(Scene scene);
/// Relative error that the fit with these poles gives the answer to a contact's force; 0 without a modal plate. @throws std::bad_alloc
double pole_error(const Scene& scene);

/// Advice for a valid scene. Independent of output.duration_s, so that runs of any length agree bit for bit.
/// Aims at asked_accuracy(). @throws std::bad_alloc
StepAdvice advise_step(const Scene& scene);

/// An advice, and the pilot with the recommended step.
struct AdvisedStep {
    StepAdvice advice;
    Trial trial;
};

/// The longest piece of a series whose own relative error is expected to be within a tolerance, estimated without a pilot [s].
double expected_piece(const Scene& scene, double tolerance);

/// The longest steps whose pilot differs from the reference by less than the accuracy. For leapfrog and chin4a the step is halved until
/// it differs by less than half; for series the longest pieces are looked for that bring the error to between 0.12 and 0.6 of it. Where
/// nothing switches the longest piece allowed may be better than that already.
/// @param scene its integrator is set. @throws std::bad_alloc
AdvisedStep advise(const Scene& scene, ReferencePilot& reference);

}  // namespace hertzline
