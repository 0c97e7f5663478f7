// How a solver takes over the motion of the one before it, when the horn's drive changes.

#include <algorithm>

#include "core/solvers/series_solver.hpp"
#include "core/solvers/stepped_solver.hpp"

namespace hertzline {

void SeriesSolver::end_at(std::int64_t sample) noexcept {
    last_moment_ = {sample, 0};
    if (asleep_ && end_.rounded_up() > sample) {
        end_ = last_moment_;
    }
}

Status SeriesSolver::reach_last_moment() noexcept {
    while (difference(last_moment_, end_) >= sliver) {
        if (const Status status = take_piece(); status != Status::running) {
            return status;
        }
    }
    plate_outputs_.leave_piece({begin_, end_});
    return finite() ? Status::running : Status::unstable;
}

Status SeriesSolver::continue_from(Solver& other) noexcept {
    auto& before = static_cast<SeriesSolver&>(other);
    const Status ended = before.reach_last_moment();
    reset();
    if (ended != Status::running) {
        return ended;
    }
    state_.take_motion(before.state());
    // a horn that has become next to silent does not ask for the last digit of what still rings
    constexpr double smallest_share = 1e-6;
    judge_by(std::max(scale_, smallest_share * state_.v.abs().maxCoeff()));
    if (plate_) {
        plate_->continue_from(*before.plate_);
    }
    lay_out(before.simd_chain_.active());
    // which contacts have just closed is told from their overlaps before
    std::copy_n(before.simd_chain_.column(kernels::ChainField::overlap), simd_chain_.slots(),
                simd_chain_.column(kernels::ChainField::overlap));
    plate_outputs_.continue_from(before.plate_outputs_, before.last_moment_.whole);
    ledger_ = before.ledger();
    add_work_of_jump(before.horn_displacement());
    return Status::running;
}

std::int64_t SteppedSolver::first_open_sample() const noexcept {
    const std::int64_t grid = std::max(1, sampler_.grid());
    return std::max(next_sample(), (state_.step + grid - 1) / grid);
}

Status SteppedSolver::continue_from(Solver& other) noexcept {
    auto& before = static_cast<SteppedSolver&>(other);
    if (before.sampler_.pass_over()) {
        before.run_until(before.last_sample_ * before.sampler_.grid(), before.sampler_.trace());
    }
    reset();
    if (before.status_ != Status::running) {
        return before.status_;
    }
    state_.take_motion(before.state());
    front_ = std::max(before.front_, before.simd_chain_.active());
    ledger_ = before.ledger();
    ledger_.add_work(work_of_jump(chain_, state_.x[0], before.horn_displacement(), 0));
    lay_out(front_);
    sampler_.begin_with(state_);
    begin_batch();
    return Status::running;
}

}  // namespace hertzline
