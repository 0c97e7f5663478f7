#include "hertzline/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/array/array_solver.hpp"
#include "core/model/chain.hpp"
#include "core/model/energy.hpp"
#include "core/scene/elements.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/solvers/stepped_solver.hpp"

namespace hertzline {

namespace {

SimulationOptions possible(SimulationOptions options, const Scene& scene) noexcept {
    options.taps &= taps_of(scene);
    return options;
}

/// @param chain of a scene without an array
std::unique_ptr<Solver> make_solver(const ResolvedScene& scene, const std::unique_ptr<const Chain>& alone,
                                    const SimulationOptions& options) {
    if (!alone) {
        return std::make_unique<ArraySolver>(scene, options);
    }
    const Chain& chain = *alone;
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
      chain_(is_array(this->scene()) ? nullptr : std::make_unique<const Chain>(this->scene())),
      step_s_(exact_step(scene_.step_s(), this->scene().output.sample_rate_hz)),
      solver_(make_solver(scene_, chain_, options_)) {}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

Samples Simulation::make_samples(std::size_t capacity) const {
    return {options_.taps, channel_counts(scene()), capacity};
}

void Simulation::reset() noexcept {
    solver_->reset();
    first_sample_ = 0;
    refused_ = false;
    status_ = Status::running;
}

bool Simulation::can_hand_over(const ResolvedScene& scene) noexcept {
    if (is_array(scene.scene())) {
        return false;
    }
    return is_series(scene.integrator()) ||
           steps_per_sample(scene.step_s(), scene.scene().output.sample_rate_hz) > 0;
}

Status Simulation::continue_from(Simulation& before, std::int64_t first) noexcept {
    first_sample_ = first;
    refused_ = taps() != before.taps();
    status_ = refused_ ? Status::unstable : before.status_ = before.solver_->reach_end();
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
    return solver_->steps();
}

std::size_t Simulation::elements() const noexcept {
    return chains_of(scene());
}

const Chain& Simulation::chain(std::size_t element) const noexcept {
    return solver_->chain(element);
}

std::int64_t Simulation::next_sample() const noexcept {
    return first_sample_ + solver_->next_sample();
}

std::int64_t Simulation::contact_events() const noexcept {
    return solver_->contact_events();
}

const ChainState& Simulation::state(std::size_t element) noexcept {
    return solver_->state(element);
}

double Simulation::time_s() const noexcept {
    return solver_->time_s();
}

Ledger Simulation::ledger() noexcept {
    return solver_->ledger();
}

std::string Simulation::failure() const {
    if (refused_) {
        return "the simulation to be continued has other taps";
    }
    return status_ == Status::unstable ? solver_->failure() : std::string{};
}

Status Simulation::advance(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    samples.first = solver_->next_sample();  // solvers count from 0
    samples.count = 0;
    if (status_ == Status::running) {
        samples.holds = wanted & samples.taps() & taps();
        const ChannelCounts counts = channel_counts(scene());
        for (const Tap tap : samples.holds) {
            if (samples.channels(tap) != channels_of(tap, counts)) {
                samples.holds = samples.holds - tap;  // a block of another scene
            }
        }
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
    const Solver::Energy held = solver_->energy();
    return std::abs(held.kinetic + held.stored - now.at_start - now.work + now.lost + now.passed +
                    now.holder_lost);
}

double Simulation::energy_residual() noexcept {
    const Ledger now = ledger();
    const double moved = std::max(
        {now.gross_work, now.lost, now.holder_lost, now.kinetic_at_start, solver_->energy().kinetic});
    const double missing = energy_missing();
    return moved > 0 || !std::isfinite(missing) ? missing / moved : 0;
}

double Simulation::fit_error() const noexcept {
    return solver_->fit_error();
}

MotionExtremes Simulation::extremes() noexcept {
    MotionExtremes extremes{
        .time_s = time_s(), .contact_events = contact_events(), .energy_residual = energy_residual()};
    for (std::size_t element = 0; element < elements(); ++element) {
        const Chain& chain = this->chain(element);
        const Eigen::ArrayXd& peaks = state(element).peak_overlap;
        double last_press_m = 0;
        for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
            if (chain.stiffness[c] > 0) {  // the contact of a free end never pushes
                last_press_m = peaks[c] - chain.static_overlap[c];
                extremes.largest_press_m = std::max(extremes.largest_press_m, last_press_m);
            }
        }
        extremes.last_press_m = std::max(extremes.last_press_m, last_press_m);
    }
    return extremes;
}

double Simulation::memory_bytes(const Scene& scene, TapSet taps) {
    if (is_array(scene)) {
        return ArraySolver::memory_bytes(scene, taps & taps_of(scene));
    }
    constexpr double columns = 14;  // of Chain and ChainState, a double for each body
    const double bodies = static_cast<double>(scene.chain.spheres) + 1;
    const TapSet given = taps & taps_of(scene);
    const bool series = scene.numerics.integrator && is_series(*scene.numerics.integrator);
    const double solver = series ? SeriesSolver::memory_bytes(bodies, scene.chain.damping_law)
                                 : SteppedSolver::memory_bytes(bodies, given);
    return bodies * columns * sizeof(double) + (solver + PlateOutputs::bytes(scene, given));
}

}  // namespace hertzline
