#include "core/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/model/energy.hpp"
#include "core/solvers/sampler.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/solvers/stepped_solver.hpp"

namespace hertzline {

std::unique_ptr<Solver> make_solver(const Scene& scene, const Chain& chain, Wish most,
                                    WavefrontTracking tracking) {
    if (!scene.numerics.integrator || !scene.numerics.step_s) {
        throw std::invalid_argument("Simulation: the scene's integrator and step are not resolved");
    }
    if (is_series(*scene.numerics.integrator)) {
        return std::make_unique<SeriesSolver>(scene, chain, most);
    }
    return std::make_unique<SteppedSolver>(scene, chain, most, tracking);
}

Simulation::Simulation(const Scene& scene, Wish most, WavefrontTracking tracking)
    : chain_(std::make_unique<const Chain>(scene)),
      step_s_(exact_step(scene.numerics.step_s.value_or(0), scene.output.sample_rate_hz)),
      solver_(make_solver(scene, *chain_, most, tracking)) {}

void Simulation::reset() noexcept {
    solver_->reset();
    status_ = Status::running;
}

double Simulation::energy_residual() noexcept {
    const Ledger books = solver_->ledger();
    const double scale = std::max(std::abs(books.work), books.lost);
    if (scale == 0) {
        return 0;
    }
    const ChainState& now = solver_->state();
    const double held =
        kinetic_energy(*chain_, now) + stored_energy(*chain_, now, solver_->horn_displacement());
    return std::abs(held - books.at_start - books.work + books.lost) / scale;
}

std::string Simulation::failure() const {
    return status_ == Status::running ? std::string{} : solver_->failure();
}

Status Simulation::advance(Samples& samples, std::size_t count, Wish wish) noexcept {
    samples.first = next_sample();
    samples.count = 0;
    samples.holds = wish;
    const auto block = static_cast<std::int64_t>(std::min(count, samples.capacity));
    if (!wish.outputs && !wish.chain()) {
        const Status status = skip(block);
        samples.count = static_cast<std::size_t>(next_sample() - samples.first);
        return status;
    }
    if (status_ == Status::running) {
        status_ = solver_->produce(&samples, block);
    }
    if (status_ != Status::running) {
        samples.count = 0;
    }
    return status_;
}

Status Simulation::skip(std::int64_t count) noexcept {
    if (status_ == Status::running) {
        status_ = solver_->produce(nullptr, count);
    }
    return status_;
}

double Simulation::memory_bytes(const Scene& scene, Wish most) noexcept {
    const auto bodies = static_cast<double>(scene.chain.spheres) + 1;
    const double state_and_constants = bodies * 8 * 11;
    const bool series = scene.numerics.integrator && is_series(*scene.numerics.integrator);
    return state_and_constants +
           (series ? SeriesSolver::memory_bytes(bodies) : SteppedSolver::memory_bytes(bodies, most));
}

}  // namespace hertzline
