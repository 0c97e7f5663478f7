#include "core/solvers/solver.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/solvers/series_solver.hpp"
#include "core/solvers/stepped_solver.hpp"

namespace hertzline {

Status Solver::fill(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    samples.first = next_sample();
    samples.count = 0;
    samples.holds = wanted & samples.taps();
    const auto block = static_cast<std::int64_t>(std::min(count, samples.capacity()));
    const bool nothing = samples.holds.empty();
    const Status status = produce(nothing ? nullptr : &samples, block);
    if (status != Status::running) {
        samples.count = 0;
    } else if (nothing) {
        samples.count = static_cast<std::size_t>(next_sample() - samples.first);
    }
    return status;
}

std::unique_ptr<Solver> make_solver(const Scene& scene, const Chain& chain,
                                    const SimulationOptions& options) {
    if (!scene.numerics.integrator || !scene.numerics.step_s) {
        throw std::invalid_argument("make_solver: the scene's integrator and step are not resolved");
    }
    if (is_series(*scene.numerics.integrator)) {
        return std::make_unique<SeriesSolver>(scene, chain, options);
    }
    if (chain.end.plate || chain.damping_law != DampingLaw::dashpot) {
        throw std::invalid_argument(
            "make_solver: modal plates and laws of damping other than the dashpot need a series");
    }
    return std::make_unique<SteppedSolver>(scene, chain, options);
}

double solver_bytes(const Scene& scene, TapSet taps) noexcept {
    const double bodies = static_cast<double>(scene.chain.spheres) + 1;
    const bool series = scene.numerics.integrator && is_series(*scene.numerics.integrator);
    double delayed = 0;  // samples on their way to the hydrophone
    if (taps.contains(Tap::p_axis)) {
        const auto& fluid = std::get<Fluid>(*find_material(scene, scene.medium.material));
        delayed = (scene.output.hydrophone_m + scene.end.radius_m) / fluid.sound_speed_m_per_s *
                  scene.output.sample_rate_hz;
    }
    return (series ? SeriesSolver::memory_bytes(bodies, scene.chain.damping_law)
                   : SteppedSolver::memory_bytes(bodies, taps)) +
           PlateOutputs::bytes(delayed);
}

}  // namespace hertzline
