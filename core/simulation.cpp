#include "hertzline/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/model/chain.hpp"
#include "core/model/energy.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/solvers/stepped_solver.hpp"

namespace hertzline {

namespace {

SimulationOptions possible(SimulationOptions options, const Scene& scene) noexcept {
    options.taps &= taps_of(scene);
    return options;
}

std::unique_ptr<Solver> make_solver(const ResolvedScene& scene, const Chain& chain,
                                    const SimulationOptions& options) {
    if (is_series(scene.integrator())) {
        return std::make_unique<SeriesSolver>(scene, chain, options);
    }
    if (chain.end.plate || chain.damping_law != DampingLaw::dashpot) {
        throw std::invalid_argument(
            "modal plates and laws of damping other than the dashpot need a series (taylor8 or taylor12)");
    }
    return std::make_unique<SteppedSolver>(scene, chain, options);
}

}  // namespace

Simulation::Simulation(ResolvedScene scene, const SimulationOptions& options)
    : scene_(std::move(scene)),
      options_(possible(options, this->scene())),
      chain_(std::make_unique<const Chain>(this->scene())),
      step_s_(exact_step(scene_.step_s(), this->scene().output.sample_rate_hz)),
      solver_(make_solver(scene_, *chain_, options_)) {}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

Samples Simulation::make_samples(std::size_t capacity) const {
    return {options_.taps, channel_counts(scene()), capacity};
}

void Simulation::reset() noexcept {
    solver_->reset();
    first_sample_ = 0;
    status_ = Status::running;
}

bool Simulation::can_hand_over(const ResolvedScene& scene) noexcept {
    return is_series(scene.integrator()) ||
           steps_per_sample(scene.step_s(), scene.scene().output.sample_rate_hz) > 0;
}

Status Simulation::continue_from(Simulation& before, std::int64_t first) noexcept {
    first_sample_ = first;
    status_ = before.status_ = before.solver_->reach_end();
    if (status_ == Status::running) {
        solver_->begin_with(before.solver_->motion());
    }
    return status_;
}

std::int64_t Simulation::first_open_sample() const noexcept {
    return first_sample_ + solver_->first_open_sample();
}

void Simulation::end_at(std::int64_t sample) noexcept {
    solver_->end_at(sample - first_sample_);
}

std::int64_t Simulation::steps() const noexcept {
    return solver_->state().step;
}

std::int64_t Simulation::next_sample() const noexcept {
    return first_sample_ + solver_->next_sample();
}

std::int64_t Simulation::contact_events() const noexcept {
    return solver_->contact_events();
}

const ChainState& Simulation::state() noexcept {
    return solver_->state();
}

double Simulation::time_s() const noexcept {
    return solver_->time_s();
}

Ledger Simulation::ledger() noexcept {
    return solver_->ledger();
}

std::string Simulation::failure() const {
    return status_ == Status::unstable ? solver_->failure() : std::string{};
}

Status Simulation::advance(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    samples.first = solver_->next_sample();  // solvers count from 0
    samples.count = 0;
    if (status_ == Status::running) {
        samples.holds = wanted & samples.taps();
        const auto block = static_cast<std::int64_t>(std::min(count, samples.capacity()));
        const bool nothing = samples.holds.empty();
        status_ = solver_->produce(nothing ? nullptr : &samples, block);
        if (status_ != Status::running) {
            samples.count = 0;
        } else if (nothing) {
            samples.count = static_cast<std::size_t>(solver_->next_sample() - samples.first);
        }
    }
    samples.first += first_sample_;
    return status_;
}

Status Simulation::skip(std::int64_t count) noexcept {
    if (status_ == Status::running) {
        status_ = solver_->produce(nullptr, count);
    }
    return status_;
}

double Simulation::energy_missing() noexcept {
    const Ledger now = ledger();
    const double held =
        kinetic_energy(*chain_, state()) + stored_energy(*chain_, state(), solver_->horn_displacement());
    return std::abs(held - now.at_start - now.work + now.lost + now.passed + now.holder_lost);
}

double Simulation::energy_residual() noexcept {
    const Ledger now = ledger();
    const double moved = std::max(
        {now.gross_work, now.lost, now.holder_lost, now.kinetic_at_start, kinetic_energy(*chain_, state())});
    return moved > 0 ? energy_missing() / moved : 0;
}

MotionExtremes Simulation::extremes() noexcept {
    MotionExtremes extremes{
        .time_s = time_s(), .contact_events = contact_events(), .energy_residual = energy_residual()};
    const Eigen::ArrayXd& peaks = state().peak_overlap;
    for (Eigen::Index c = 0; c < chain_->bodies(); ++c) {
        if (chain_->stiffness[c] > 0) {  // the contact of a free end never pushes
            extremes.last_press_m = peaks[c] - chain_->static_overlap[c];
            extremes.largest_press_m = std::max(extremes.largest_press_m, extremes.last_press_m);
        }
    }
    return extremes;
}

double Simulation::memory_bytes(const Scene& scene, TapSet taps) noexcept {
    constexpr double columns = 14;  // of Chain and ChainState, a double for each body
    const double bodies = static_cast<double>(scene.chain.spheres) + 1;
    const TapSet given = taps & taps_of(scene);
    const bool series = scene.numerics.integrator && is_series(*scene.numerics.integrator);
    const double solver = series ? SeriesSolver::memory_bytes(bodies, scene.chain.damping_law)
                                 : SteppedSolver::memory_bytes(bodies, given);
    return bodies * columns * sizeof(double) + (solver + PlateOutputs::bytes(scene, given));
}

}  // namespace hertzline
