#pragma once
// Scene -> Chain + ChainState -> samples. Owns the physics; knows no clock, thread, log, socket or file.

#include <cstdint>
#include <memory>
#include <string>

#include "core/model/chain.hpp"
#include "core/scene/scene.hpp"
#include "core/solvers/solver.hpp"

namespace hertzline {

/// How far a motion has gone from its start to some moment.
struct MotionExtremes {
    double time_s = 0;                ///< the moment [s]
    double largest_press_m = 0;       ///< largest overlap of any contact so far, beyond that at rest [m]
    double last_press_m = 0;          ///< the same of the last contact [m]
    std::int64_t contact_events = 0;  ///< openings and closings so far
    double energy_residual = 0;       ///< as Simulation::energy_residual()
};

/// A scene in motion. Owns all that it needs; not for several threads at once.
class Simulation {
public:
    /// Takes a Resolution of resolve(), too. @throws std::bad_alloc; std::invalid_argument where a grid is to integrate a modal plate or
    /// a law of damping other than the dashpot, which validate() refuses
    explicit Simulation(ResolvedScene scene, const SimulationOptions& options = {});

    /// A block for advance(), with room for all taps of the options. @throws std::bad_alloc
    Samples make_samples(std::size_t capacity) const;

    /// Back to sample 0, at static equilibrium.
    void reset() noexcept;

    /// From here on the first sample has this number instead of 0; for a simulation that has not begun.
    void begin_at(std::int64_t sample) noexcept { first_sample_ = sample; }

    // One simulation after another in the same run: end_at() sets the end of the first one, which gives all samples before and hands its
    // motion over. Both drives restart their bursts at the first sample of the second.

    /// Whether the motion of a scene can be handed over to one with another drive: that of a series, and that of a grid whose steps
    /// divide the sample period. @param scene with integrator and step
    static bool can_hand_over(const ResolvedScene& scene) noexcept;
    /// The first sample at which end_at() can let it end: the motion has not gone further.
    std::int64_t first_open_sample() const noexcept { return first_sample_ + solver_->first_open_sample(); }
    /// The motion will end at this sample, which belongs to the simulation that follows. @param sample first_open_sample() or later
    void end_at(std::int64_t sample) noexcept { solver_->end_at(sample - first_sample_); }
    /// Begins at sample `first`, where `before` ends, with its motion and account of energy. Allocates nothing.
    /// @param before can_hand_over(); its scene differs in drive and step only; has given all samples before `first`
    /// @returns the status of `before` at its end
    Status continue_from(Simulation& before, std::int64_t first) noexcept;

    /// The next `count` samples (at most the block's capacity) of the wanted taps for which the block has room. Allocates nothing. If
    /// the step turns out to lie beyond the stability limit the block comes back empty, and failure() names place and time.
    Status advance(Samples& samples, std::size_t count, TapSet wanted) noexcept;
    /// The same for all taps of the block.
    Status advance(Samples& samples, std::size_t count) noexcept {
        return advance(samples, count, samples.taps());
    }

    /// Passes over the next `count` samples: the motion continues, nothing is written.
    Status skip(std::int64_t count) noexcept;

    const Scene& scene() const noexcept { return scene_.scene(); }  ///< with integrator and step
    TapSet taps() const noexcept { return options_.taps; }
    const Chain& chain() const noexcept { return *chain_; }
    /// Step of a grid, or the longest piece of a series [s].
    double step_s() const noexcept { return step_s_; }
    /// Steps or pieces so far.
    std::int64_t steps() const noexcept { return solver_->state().step; }
    std::int64_t next_sample() const noexcept { return first_sample_ + solver_->next_sample(); }
    std::int64_t contact_events() const noexcept { return solver_->contact_events(); }

    /// State at the last step taken. Not cheap: for tests, checks and ledgers, not for each sample.
    const ChainState& state() noexcept { return solver_->state(); }
    /// Its time since the simulation's first sample [s]. Steps do not end where samples lie.
    double time_s() const noexcept { return solver_->time_s(); }
    Ledger ledger() noexcept { return solver_->ledger(); }
    /// Energy that no entry of the ledger accounts for, |kinetic + stored - start - work + lost + passed| [J].
    double energy_missing() noexcept;
    /// The same relative to the largest of the horn's work back and forth, the losses and the kinetic energy.
    double energy_residual() noexcept;
    /// Takes a pass over the chain. Allocates nothing.
    MotionExtremes extremes() noexcept;

    /// Why the simulation failed, for a human; empty if it did not.
    std::string failure() const;

    /// Bytes that a simulation of this scene needs, roughly from above.
    static double memory_bytes(const Scene& scene, TapSet taps) noexcept;

private:
    ResolvedScene scene_;
    SimulationOptions options_;
    std::unique_ptr<const Chain> chain_;
    double step_s_;
    std::unique_ptr<Solver> solver_;
    std::int64_t first_sample_ = 0;
    Status status_ = Status::running;
};

}  // namespace hertzline
