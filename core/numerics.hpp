#pragma once
// Choosing integrator and step: what a scene leaves open is settled here, by measuring instead of guessing.
//
// A pilot runs the scene over its first burst with a step and with half of it. Their difference, extrapolated
// with the method's order, is the error; halving goes on until it is below the wanted accuracy. A pilot costs
// about as much as simulating a few milliseconds. The contacts' largest overlaps in it tell the largest
// stable step.

#include <string>
#include <vector>

#include "core/scene.hpp"

namespace hertzline {

/// Relative L2 error of the velocities that a scene gets when it asks for nothing.
inline constexpr double default_accuracy = 1e-4;

/// What a pilot found out about a scene.
struct StepAdvice {
    double recommended_step_s = 0;     ///< meets the accuracy; fits the sample grid
    double estimated_error = 0;        ///< relative L2, of all velocities at that step
    double largest_stable_step_s = 0;  ///< with the largest overlaps of the pilot
    double pilot_duration_s = 0;
    bool accuracy_met = true;  ///< false: not even the smallest step tried came close (a chaotic scene)
};

/// The scene with its integrator set: its own, or chin4a for chains that fit into registers and leapfrog for
/// longer ones, where somewhere a contact switches in almost every step and locating each would cost more
/// than it gains.
Scene with_integrator(Scene scene);

/// Advice for a valid scene. Independent of output.duration_s, so that runs of any length agree bit for bit.
/// Aims at numerics.accuracy or default_accuracy. @throws std::bad_alloc
StepAdvice advise_step(const Scene& scene);

/// A valid scene with integrator and step settled, or what is wrong with its step.
struct Resolved {
    Scene scene;  ///< numerics.integrator and step_s set, accuracy unset
    StepAdvice advice;
    std::vector<Fault> faults;  ///< step beyond the stability limit
};
Resolved resolved(const Scene& scene);

}  // namespace hertzline
