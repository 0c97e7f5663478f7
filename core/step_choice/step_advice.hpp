#pragma once
// Which step gives the accuracy that is asked for: pilots run with several steps, and their errors are measured.

#include "core/scene/scene.hpp"
#include "core/step_choice/reference_pilot.hpp"

namespace hertzline {

/// An error that shorter steps do not bring below this is no truncation error: the motion is chaotic.
inline constexpr double chaotic_error = 0.05;

/// Results of the pilots of a scene. A step is the longest piece of a series, or the step of a grid.
struct StepAdvice {
    double accuracy = default_accuracy;  ///< the wanted one: numerics.accuracy or the default
    double recommended_step_s = 0;       ///< meets the accuracy; of a grid: fits that of the samples
    double estimated_error = 0;          ///< relative L2, of the worst velocity at that step
    double largest_stable_step_s = 0;    ///< with the largest overlaps of the pilots
    bool accuracy_met = true;            ///< false: not even the smallest step tried can be shown to
    int pilots = 0;                      ///< run to find this out, beside the reference,
    double pilot_duration_s = 0;         ///< each over this simulated time
};

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
AdvisedStep advise(const Scene& scene, const ReferencePilot& reference);

}  // namespace hertzline
