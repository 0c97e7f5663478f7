#include "core/step_choice/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/solvers/solver.hpp"

namespace hertzline {

Pilot run_pilot(const PilotPlan& plan, Integrator integrator, double step_s) {
    Scene scene = plan.scene;
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = step_s;
    constexpr std::size_t block = 256;
    const Chain chain(scene);
    const TapSet outputs = chain.end.has_plate ? TapSet(Tap::v_plate) | Tap::v_out : TapSet();
    const TapSet taps = outputs | Tap::v_chain;
    const auto solver = make_solver(scene, chain, {.taps = taps, .ledger = LedgerKeeping::off});
    Samples part(taps, static_cast<std::size_t>(chain.spheres()), block);
    Pilot result;
    result.columns = static_cast<std::size_t>(channels_of(taps, static_cast<double>(chain.spheres())));
    result.velocities.reserve(plan.samples * result.columns);
    for (std::size_t done = 0; done < plan.samples && result.stable; done += block) {
        result.stable = solver->fill(part, std::min(block, plan.samples - done), taps) == Status::running;
        for (std::size_t i = 0; i < part.count; ++i) {
            const auto row = part[Tap::v_chain].subspan(i * part.spheres(), part.spheres());
            result.velocities.insert(result.velocities.end(), row.begin(), row.end());
            if (chain.end.has_plate) {
                result.velocities.push_back(part[Tap::v_plate][i]);
                result.velocities.push_back(part[Tap::v_out][i]);
            }
        }
    }
    result.peak_overlap = solver->state().peak_overlap;
    result.steps = solver->state().step;
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
    constexpr double floor = 1e-6;  // of the largest energy
    double worst = 0;
    over_columns([&](double difference, double norm) {
        const double scale = std::max(norm, floor * largest_norm);
        worst = scale > 0 ? std::max(worst, difference / scale) : worst;
    });
    return std::sqrt(worst);
}

}  // namespace hertzline
