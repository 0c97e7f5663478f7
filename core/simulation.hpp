#pragma once
// Scene -> Chain + ChainState -> samples. Owns the physics; knows no clock, thread, log, socket or file.

#include <cstdint>
#include <memory>
#include <string>

#include "core/model/chain.hpp"
#include "core/model/state.hpp"
#include "core/scene/scene.hpp"
#include "core/solvers/solver.hpp"

namespace hertzline {

class Simulation {
public:
    /// @param scene validated and resolved (numerics.hpp): integrator and step_s are set. @param most the
    /// largest wish that advance() will get. @throws std::invalid_argument if the scene is not resolved;
    /// std::bad_alloc
    Simulation(const Scene& scene, Wish most, WavefrontTracking tracking = WavefrontTracking::on);

    /// Back to sample 0, at static equilibrium.
    void reset() noexcept;

    /// The next `count` samples (at most samples.capacity). Allocates nothing. If the step turns out to lie
    /// beyond the stability limit the block comes back empty, and failure() tells where and when.
    Status advance(Samples& samples, std::size_t count, Wish wish) noexcept;

    /// Passes over the next `count` samples: the motion goes on, nothing is put down.
    Status skip(std::int64_t count) noexcept;

    const Chain& chain() const noexcept { return *chain_; }
    /// Step of a grid, or the longest piece of a series [s].
    double step_s() const noexcept { return step_s_; }
    /// Steps or pieces so far.
    std::int64_t steps() const noexcept { return solver_->state().step; }
    std::int64_t next_sample() const noexcept { return solver_->next_sample(); }
    std::int64_t contact_events() const noexcept { return solver_->contact_events(); }

    /// State at the last step taken. Not cheap: for tests, checks and ledgers, not for each sample.
    const ChainState& state() noexcept { return solver_->state(); }
    /// Its time [s]. Steps do not end where samples lie.
    double time_s() const noexcept { return solver_->time_s(); }
    Ledger ledger() noexcept { return solver_->ledger(); }
    /// |kinetic + stored - start - work + lost| over the work done.
    double energy_residual() noexcept;

    /// What went wrong, for a human; empty while running.
    std::string failure() const;

    /// Bytes that a simulation of this scene needs, roughly from above.
    static double memory_bytes(const Scene& scene, Wish most) noexcept;

private:
    std::unique_ptr<const Chain> chain_;
    double step_s_;
    std::unique_ptr<Solver> solver_;
    Status status_ = Status::running;
};

}  // namespace hertzline
