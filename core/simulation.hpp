#pragma once
// Scene -> Chain + ChainState -> samples. Owns the physics; knows no clock, thread, log, socket or file.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/chain.hpp"
#include "core/energy.hpp"
#include "core/integrators/folded_chain.hpp"
#include "core/sampler.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"
#include "core/tone_burst.hpp"

namespace hertzline {

/// Whether the integration still stands.
enum class Status { running, unstable };

/// What is done about bodies that no disturbance has reached yet. With leapfrog the samples are the same, to
/// the last bit.
enum class AtRest {
    skipped,
    worked_on,  ///< as if they moved: for tests and benchmarks
};

class Simulation {
public:
    /// @param scene validated and resolved (numerics.hpp): integrator and step_s are set. @param most the
    /// largest wish that advance() will get. @throws std::invalid_argument if the scene is not resolved;
    /// std::bad_alloc
    Simulation(const Scene& scene, Wish most, AtRest at_rest = AtRest::skipped);

    /// Back to sample 0, at static equilibrium.
    void reset() noexcept;

    /// The next `count` samples (at most samples.capacity). Allocates nothing. If the step turns out to lie
    /// beyond the stability limit the block comes back empty, and failure() tells where and when.
    Status advance(Samples& samples, std::size_t count, Wish wish) noexcept;

    /// Passes over the next `count` samples: the motion goes on, nothing is put down.
    Status skip(std::int64_t count) noexcept;

    const Chain& chain() const noexcept { return chain_; }
    double step_s() const noexcept { return step_s_; }
    std::int64_t steps() const noexcept { return state_.step; }
    std::int64_t next_sample() const noexcept { return sampler_.next_sample(); }
    std::int64_t contact_events() const noexcept { return folded_.contact_events; }

    /// State at the last step taken. Not cheap: for tests, checks and ledgers, not for each sample.
    const ChainState& state() noexcept;
    Ledger ledger() noexcept;
    /// |kinetic + stored - start - work + lost| over the work done.
    double energy_residual() noexcept;

    /// What went wrong, for a human; empty while running.
    std::string failure() const;

    /// Bytes that a simulation of this scene needs, roughly from above.
    static double memory_bytes(const Scene& scene, Wish most) noexcept;

private:
    void run_until(std::int64_t step, Trace& trace) noexcept;
    void begin_batch() noexcept;
    void fold_active() noexcept;
    void collect_ledger() noexcept;
    bool stable() noexcept;
    void watch_from(double overlap) noexcept;
    Status produce(Samples* samples, std::int64_t count) noexcept;

    Chain chain_;
    Integrator integrator_;
    double step_s_;
    AtRest at_rest_;
    double limit_at_rest_;  ///< largest stable step of the chain at rest [s]
    ToneBurst burst_;
    ChainState state_;
    FoldedChain folded_;
    Kernel kernel_ = nullptr;
    std::vector<HornStep> horn_;
    std::int64_t horn_first_ = -1;
    Eigen::Index front_ = 0;  ///< bodies from here on are still at rest, exactly
    Sampler sampler_;
    Ledger ledger_;
    Status status_ = Status::running;
};

}  // namespace hertzline
