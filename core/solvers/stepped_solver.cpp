#include "core/solvers/stepped_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "core/integrators/stability.hpp"

namespace hertzline {

SteppedSolver::SteppedSolver(const ResolvedScene& resolved, const Chain& chain,
                             const SimulationOptions& options)
    : chain_(chain),
      integrator_(resolved.integrator()),
      step_s_(exact_step(resolved.step_s(), resolved.scene().output.sample_rate_hz)),
      options_(options),
      limit_at_rest_(largest_stable_step(chain_, chain_.static_overlap, integrator_)),
      horn_(make_horn(resolved.scene().drive, step_s_, options.live)),
      state_(chain_),
      simd_chain_(chain_, integrator_, kernels::kernel_lanes()),
      horn_steps_(Horn::batch_steps),
      sampler_(chain_, resolved.scene(), step_s_, options) {
    simd_chain_.step_s = step_s_;
    reset();
}

void SteppedSolver::reset() noexcept {
    state_.reset(chain_);
    simd_chain_.contact_events = 0;
    ledger_ = {};
    begin_ledger(chain_, state_, ledger_);
    status_ = Status::running;
    horn_first_ = -1;
    front_ = options_.tracking == WavefrontTracking::off || !chain_.balanced() ? chain_.bodies()
                                                                               : chain_.impact_spheres;
    lay_out(front_);
    sampler_.reset();
    begin_batch();
}

void SteppedSolver::lay_out(Eigen::Index active) noexcept {
    simd_chain_.load(chain_, state_, active);
    kernel_ = kernels::kernel(integrator_, simd_chain_.kernel_rows());
}

const ChainState& SteppedSolver::state(std::size_t /*element*/) noexcept {
    simd_chain_.store(state_);
    return state_;
}

/// At every multiple of batch_steps: ledger, wavefront and drive. Depends on the step count alone, never on block sizes.
void SteppedSolver::begin_batch() noexcept {
    collect_ledger();
    load_active();
    horn_->fill(state_.step, horn_steps_.data(), Horn::batch_steps);
    horn_first_ = state_.step;
}

void SteppedSolver::load_active() noexcept {
    const Eigen::Index bodies = chain_.bodies();
    if (simd_chain_.active() == bodies) {
        return;
    }
    simd_chain_.store(state_);
    front_ = std::max(front_, simd_chain_.active());
    while (front_ > 0 && front_ < bodies && state_.x[front_ - 1] == 0 && state_.v[front_ - 1] == 0) {
        --front_;
    }
    const Eigen::Index reach = method(integrator_).reach;
    lay_out(std::min(bodies, front_ + reach * Horn::batch_steps + 1));
}

void SteppedSolver::collect_ledger() noexcept {
    ledger_ = ledger();
    std::fill_n(simd_chain_.column(kernels::ChainField::lost), simd_chain_.ledger_slots(), 0.0);
    std::fill_n(simd_chain_.column(kernels::ChainField::work), simd_chain_.lanes(), 0.0);
    std::fill_n(simd_chain_.column(kernels::ChainField::gross_work), simd_chain_.lanes(), 0.0);
    simd_chain_.held_lost = 0;
}

/// A look must not change how later sums round, so the columns are only read.
Ledger SteppedSolver::ledger() noexcept {
    const auto booked = [this](kernels::ChainField field, std::size_t slots, double before) {
        const double* const column = simd_chain_.column(field);
        return std::accumulate(column, column + slots, before);
    };
    return {.work = booked(kernels::ChainField::work, simd_chain_.lanes(), ledger_.work),
            .gross_work = booked(kernels::ChainField::gross_work, simd_chain_.lanes(), ledger_.gross_work),
            .lost = booked(kernels::ChainField::lost, simd_chain_.ledger_slots(), ledger_.lost),
            .at_start = ledger_.at_start,
            .kinetic_at_start = ledger_.kinetic_at_start,
            .holder_lost = ledger_.holder_lost + simd_chain_.held_lost};
}

Solver::Energy SteppedSolver::energy() noexcept {
    return {kinetic_energy(chain_, state(0)), stored_energy(chain_, state(0), horn_displacement())};
}

double SteppedSolver::horn_displacement() const noexcept {
    return horn_->at(state_.step, 0, -1e-6).x;
}

bool SteppedSolver::stable() noexcept {
    if (!simd_chain_.beyond_watched) {
        return true;
    }
    // peaks only ever grow, so a block that ends within the limit never left it; ahead of the wavefront nothing changes
    for (Eigen::Index b = 0; b < simd_chain_.active(); ++b) {
        state_.peak_overlap[b] = simd_chain_.column(kernels::ChainField::peak_overlap)[simd_chain_.slot(b)];
    }
    const auto peaks = state_.peak_overlap.head(simd_chain_.active());
    if (simd_chain_.layout() == kernels::Layout::linear) {
        watch_from(2 * (chain_.stiffness > 0).select(peaks, 0).maxCoeff());
    }
    return step_s_ <= std::min(largest_stable_step(chain_, peaks, integrator_), limit_at_rest_);
}

/// As long as the step would be stable with all contacts pressed to `overlap` [m], the kernel watches for one
/// that is pressed further, instead of a look at each of them.
void SteppedSolver::watch_from(double overlap) noexcept {
    if (step_s_ <= largest_stable_step(chain_, overlap, integrator_)) {
        simd_chain_.watched_overlap = overlap;
        simd_chain_.beyond_watched = false;
    }
}

std::string SteppedSolver::failure() const {
    const double time_s = static_cast<double>(state_.step) * step_s_;
    std::array<char, 256> text{};
    for (Eigen::Index c = 0; c < chain_.bodies(); ++c) {
        if (!std::isfinite(state_.peak_overlap[c])) {
            std::snprintf(text.data(), text.size(),
                          "the step of %.4g s is beyond the stability limit: the overlap of contact %lld "
                          "overflowed before t = %.6g s",
                          step_s_, static_cast<long long>(c), time_s);
            return text.data();
        }
    }
    Eigen::Index contact = 0;
    (chain_.stiffness.square() * state_.peak_overlap).maxCoeff(&contact);
    std::snprintf(text.data(), text.size(),
                  "the step of %.4g s is beyond the stability limit, which fell to %.4g s before "
                  "t = %.6g s "
                  "(stiffest: contact %lld, overlap %.3g m)",
                  step_s_, largest_stable_step(chain_, state_.peak_overlap, integrator_), time_s,
                  static_cast<long long>(contact), state_.peak_overlap[contact]);
    return text.data();
}

/// Leapfrog takes a step in which the horn's motion changes its formula part by part: between the parts the horn may jump, which is
/// work. The other kernels do so themselves.
void SteppedSolver::take_in_parts(kernels::Trace& trace) noexcept {
    constexpr int most_parts = 16;  // more would mean a step far too large for the drive
    kernels::Trace nothing;
    nothing.capacity = kernels::max_rows_per_step;
    nothing.bodies = nothing.first_body = chain_.bodies();
    double horn = horn_displacement();
    double from = 0;
    for (int part = 1; from < 1; ++part) {
        const double to = part < most_parts ? horn_->next_break(state_.step, from) : 1;
        const double inside = 0.5 * (from + to);
        const HornStep smooth{.start = horn_->at(state_.step, from, inside),
                              .middle = horn_->at(state_.step, inside, inside),
                              .end = horn_->at(state_.step, to, inside)};
        const double x = simd_chain_.column(kernels::ChainField::x)[simd_chain_.slot(0)];
        ledger_.add_work(work_of_jump(chain_, x, horn, smooth.start.x));
        simd_chain_.step_s = (to - from) * step_s_;
        kernel_(simd_chain_, *horn_, &smooth, state_.step, 1, to < 1 ? nothing : trace);
        horn = smooth.end.x;
        from = to;
    }
    simd_chain_.step_s = step_s_;
}

/// At most `count` steps of the present batch; as many as the trace has room for. @returns how many
int SteppedSolver::take_steps(int count, kernels::Trace& trace) noexcept {
    const HornStep* const horn = horn_steps_.data() + (state_.step - horn_first_);
    if (integrator_ != Integrator::leapfrog) {
        return kernel_(simd_chain_, *horn_, horn, state_.step, count, trace);
    }
    const auto smooth = static_cast<int>(
        std::find_if(horn, horn + count, [](const HornStep& step) { return step.fresh; }) - horn);
    if (smooth > 0) {
        return kernel_(simd_chain_, *horn_, horn, state_.step, smooth, trace);
    }
    if (!trace.has_room()) {
        return 0;
    }
    take_in_parts(trace);
    return 1;
}

/// Takes steps until `step` is reached or the trace is full.
void SteppedSolver::run_until(std::int64_t step, kernels::Trace& trace) noexcept {
    // A batch of a long chain may take seconds: number of bodies that are moved between two checks of the stop flag.
    constexpr std::int64_t bodies_at_a_time = 1 << 24;
    const std::int64_t most = options_.stop == nullptr
                                  ? Horn::batch_steps
                                  : std::max<std::int64_t>(1, bodies_at_a_time / chain_.bodies());
    while (state_.step < step && status_ == Status::running) {
        if (options_.stop_asked(state_.step)) {
            status_ = Status::stopped;
            return;
        }
        const std::int64_t in_batch = state_.step - horn_first_;
        const std::int64_t left_in_batch = Horn::batch_steps - in_batch;
        const int count = static_cast<int>(std::min({left_in_batch, step - state_.step, most}));
        const int taken = take_steps(count, trace);
        state_.step += taken;
        if (!stable()) {
            status_ = Status::unstable;
            return;
        }
        if (state_.step == horn_first_ + Horn::batch_steps) {
            begin_batch();
        }
        if (taken == 0) {
            return;
        }
    }
}

Status SteppedSolver::produce(Samples* samples, std::int64_t count) noexcept {
    if (count <= 0 || status_ != Status::running) {
        return status_;
    }
    const std::int64_t end = next_sample() + count;
    const std::int64_t last_step = sampler_.step_needed(end);
    if (samples == nullptr && sampler_.pass_over()) {
        run_until(last_step, sampler_.trace());
        if (status_ == Status::running) {
            sampler_.passed_over(end);
        }
        return status_;
    }
    for (;;) {
        sampler_.emit(samples, end);
        if (next_sample() == end || status_ != Status::running) {
            return status_;
        }
        run_until(last_step, sampler_.wanted_from(state_.step));
    }
}

std::int64_t SteppedSolver::first_open_sample() const noexcept {
    const std::int64_t grid = std::max(1, sampler_.grid());
    return std::max(next_sample(), (state_.step + grid - 1) / grid);
}

Status SteppedSolver::reach_end() noexcept {
    if (sampler_.pass_over()) {
        run_until(last_sample_ * sampler_.grid(), sampler_.trace());
    }
    return status_;
}

Motion SteppedSolver::motion() noexcept {
    return {.sample = last_sample_,
            .state = state(0),
            .moving = std::max(front_, simd_chain_.active()),
            .ledger = ledger(),
            .horn_m = horn_displacement(),
            .horn_m_per_s = horn_->at(state_.step, 0, -1e-6).v};
}

void SteppedSolver::begin_with(const Motion& motion) noexcept {
    reset();
    state_.take_motion(motion.state);
    front_ = motion.moving;
    ledger_ = motion.ledger;
    ledger_.add_work(work_of_jump(chain_, state_.x[0], motion.horn_m, 0));
    lay_out(front_);
    sampler_.begin_with(state_);
    begin_batch();
}

double SteppedSolver::memory_bytes(double bodies, TapSet taps) noexcept {
    const double folded = (bodies + 64) * 8 * static_cast<double>(kernels::ChainField::count);
    return folded + Sampler::bytes(bodies, taps);
}

}  // namespace hertzline
