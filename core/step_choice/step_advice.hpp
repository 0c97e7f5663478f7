#pragma once
// Which step gives the accuracy that is asked for: pilots run with several steps, and their errors are measured.

#include "core/scene/scene.hpp"
#include "core/step_choice/reference_pilot.hpp"

namespace hertzline {

/// Relative L2 error of the velocities that a scene gets when it asks for nothing.
inline constexpr double default_accuracy = 1e-4;

/// An error that shorter steps do not bring below this is no truncation error: the motion is chaotic.
inline constexpr double chaotic_error = 0.05;

/// What pilots found out about a scene. A step is the longest piece of a series, or the step of a grid.
struct StepAdvice {
    double accuracy = default_accuracy;  ///< the wanted one: numerics.accuracy or the default
    double recommended_step_s = 0;       ///< meets the accuracy; of a grid: fits that of the samples
    double estimated_error = 0;          ///< relative L2, of the worst velocity at that step
    double largest_stable_step_s = 0;    ///< with the largest overlaps of the pilots
    bool accuracy_met = true;            ///< false: not even the smallest step tried can be shown to
    int pilots = 0;                      ///< run to find this out, beside the reference,
    double pilot_duration_s = 0;         ///< each over this simulated time
};

/// For leapfrog and chin4a: the step is halved until two successive pilots agree. @param scene its integrator
/// is set. @throws std::bad_alloc
StepAdvice advise_on_grid(const Scene& scene);

/// For series: the longest pieces whose pilot differs from the reference by a tenth to the half of the
/// accuracy. Where nothing switches the longest piece allowed may be better than that already. @param scene
/// its integrator is set. @throws std::bad_alloc
StepAdvice advise_series(const Scene& scene, const ReferencePilot& reference);

}  // namespace hertzline
