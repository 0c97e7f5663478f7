#pragma once
// A scene simulated for a while to see what a step does to it: pilots with different steps are compared.

#include <vector>

#include <Eigen/Core>

#include "core/scene/scene.hpp"

namespace hertzline {

/// What a pilot simulates, and how it is sampled.
struct PilotPlan {
    Scene scene;  ///< integrator and step are filled in for each pilot
    std::size_t samples = 0;
};

/// Velocities over a pilot, [sample][column]: all spheres, and with a plate the plate and the output.
struct Pilot {
    std::vector<double> velocities;
    std::size_t columns = 0;
    Eigen::ArrayXd peak_overlap;  ///< largest overlap of each contact [m]
    std::int64_t steps = 0;
    bool stable = true;
};

/// @throws std::bad_alloc
Pilot run_pilot(const PilotPlan& plan, Integrator integrator, double step_s);

/// Largest relative L2 difference of any column. Bodies that move next to nothing are judged by the scale of the
/// others. Infinite if one of the pilots was unstable.
double largest_difference(const Pilot& pilot, const Pilot& better) noexcept;

}  // namespace hertzline
