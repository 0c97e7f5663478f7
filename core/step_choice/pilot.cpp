#include "core/step_choice/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/simulation.hpp"

namespace hertzline {

Pilot run_pilot(const PilotPlan& plan, Integrator integrator, double step_s) {
    Scene scene = plan.scene;
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = step_s;
    constexpr std::size_t block = 256;
    const Wish wish{.outputs = true, .chain_velocities = true, .chain_displacements = false, .ledger = false};
    Simulation simulation(scene, wish);
    Samples part(simulation.chain(), block, wish);
    const bool plate = scene.end.kind == EndKind::plate;
    Pilot result;
    result.columns = part.spheres + (plate ? 2 : 0);
    result.velocities.reserve(plan.samples * result.columns);
    for (std::size_t done = 0; done < plan.samples && result.stable; done += block) {
        result.stable =
            simulation.advance(part, std::min(block, plan.samples - done), wish) == Status::running;
        for (std::size_t i = 0; i < part.count; ++i) {
            const double* row = part.chain_v.data() + i * part.spheres;
            result.velocities.insert(result.velocities.end(), row, row + part.spheres);
            if (plate) {
                result.velocities.push_back(part.v_plate[i]);
                result.velocities.push_back(part.v_out[i]);
            }
        }
    }
    result.peak_overlap = simulation.state().peak_overlap;
    result.steps = simulation.steps();
    return result;
}

double largest_difference(const Pilot& pilot, const Pilot& better) noexcept {
    if (!pilot.stable || !better.stable) {
        return std::numeric_limits<double>::infinity();
    }
    double largest_norm = 0;
    const auto over_columns = [&](auto&& use) {
        for (std::size_t column = 0; column < better.columns; ++column) {
            double difference = 0;
            double norm = 0;
            for (std::size_t i = column; i < better.velocities.size(); i += better.columns) {
                const double d = pilot.velocities[i] - better.velocities[i];
                difference += d * d;
                norm += better.velocities[i] * better.velocities[i];
            }
            use(difference, norm);
        }
    };
    over_columns([&](double, double norm) { largest_norm = std::max(largest_norm, norm); });
    constexpr double hardly = 1e-6;  // of the largest energy
    double worst = 0;
    over_columns([&](double difference, double norm) {
        const double scale = std::max(norm, hardly * largest_norm);
        worst = scale > 0 ? std::max(worst, difference / scale) : worst;
    });
    return std::sqrt(worst);
}

}  // namespace hertzline
