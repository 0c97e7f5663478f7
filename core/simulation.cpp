#include "core/simulation.hpp"

#include <stdexcept>
#include <utility>

#include "core/solvers/sampling/sampler.hpp"
#include "core/step_choice/resolve.hpp"

namespace hertzline {

namespace {

[[noreturn]] void refuse(const std::vector<Fault>& faults) {
    std::string all = "the scene cannot be simulated";
    for (const Fault& fault : faults) {
        all += '\n' + fault.message();
    }
    throw std::invalid_argument(all);
}

/// The scene as it can be simulated: what it leaves open is chosen. One that leaves nothing open has been through resolve().
Scene simulable(const Scene& scene) {
    if (scene.numerics.integrator && scene.numerics.step_s) {
        return scene;
    }
    if (const std::vector<Fault> faults = validate(scene); !faults.empty()) {
        refuse(faults);
    }
    ResolvedScene result = resolve(scene);
    if (!result.faults.empty()) {
        refuse(result.faults);
    }
    return std::move(result.scene);
}

SimulationOptions possible(SimulationOptions options, const End& end) noexcept {
    options.taps &= taps_of(end);
    return options;
}

}  // namespace

Simulation::Simulation(const Scene& scene, const SimulationOptions& options)
    : scene_(simulable(scene)),
      options_(possible(options, scene.end)),
      chain_(std::make_unique<const Chain>(scene_)),
      step_s_(exact_step(*scene_.numerics.step_s, scene_.output.sample_rate_hz)),
      solver_(make_solver(scene_, *chain_, options_)) {}

Samples Simulation::make_samples(std::size_t capacity) const {
    return {options_.taps, static_cast<std::size_t>(chain_->spheres()), capacity};
}

void Simulation::reset() noexcept {
    solver_->reset();
    first_sample_ = 0;
    status_ = Status::running;
}

bool Simulation::can_hand_over(const Scene& scene) noexcept {
    return is_series(*scene.numerics.integrator) ||
           steps_per_sample(*scene.numerics.step_s, scene.output.sample_rate_hz) > 0;
}

Status Simulation::continue_from(Simulation& before, std::int64_t first) noexcept {
    first_sample_ = first;
    status_ = before.status_ = solver_->continue_from(*before.solver_);
    return status_;
}

std::string Simulation::failure() const {
    return status_ == Status::unstable ? solver_->failure() : std::string{};
}

Status Simulation::advance(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    if (status_ == Status::running) {
        status_ = solver_->fill(samples, count, wanted);
        samples.first += first_sample_;
    } else {
        samples.first = next_sample();
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

double Simulation::memory_bytes(const Scene& scene, TapSet taps) noexcept {
    constexpr double columns = 11;  // of Chain and ChainState, a double for each body
    const double bodies = static_cast<double>(scene.chain.spheres) + 1;
    return bodies * columns * sizeof(double) + solver_bytes(scene, taps & taps_of(scene.end));
}

}  // namespace hertzline
