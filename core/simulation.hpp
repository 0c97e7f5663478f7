#pragma once
// Scene -> Chain + ChainState -> samples. Owns the physics; knows no clock, thread, log, socket or file.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/chain.hpp"
#include "core/energy.hpp"
#include "core/integrators/folded_chain.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"
#include "core/tone_burst.hpp"

namespace hertzline {

/// What a block of samples shall hold. What is not wanted is not computed.
struct Wish {
    bool outputs = true;             ///< v_last, v_plate, v_out
    bool chain_velocities = false;   ///< of all spheres
    bool chain_displacements = false;
    bool chain() const noexcept { return chain_velocities || chain_displacements; }
};

/// A block of samples; sized once, filled by Simulation::advance().
struct Samples {
    /// @param most what advance() may ever be asked to put here @param capacity samples
    Samples(const Chain& chain, std::size_t capacity, Wish most);

    std::int64_t first = 0;   ///< index of the first sample since the start
    std::size_t count = 0;    ///< samples in this block
    std::size_t capacity = 0;
    std::size_t spheres = 0;
    Wish holds;               ///< which of the columns are filled
    std::vector<double> v_last;    ///< velocity of the last sphere [m/s], [sample]
    std::vector<double> v_plate;   ///< of the plate [m/s], [sample]; empty without a plate
    std::vector<double> v_out;     ///< into the medium [m/s], [sample]
    std::vector<double> chain_v;   ///< [m/s], [sample][sphere]
    std::vector<double> chain_x;   ///< [m], [sample][sphere]
};

/// A moment counted in steps, as a fixed-point number with 64 bits behind the point. Adding the sample period again and
/// again is exact, so the moment of a sample does not drift: after 1e12 samples it is off by 5e-8 steps.
struct StepPosition {
    std::int64_t step = 0;
    std::uint64_t part = 0;  ///< of the step, in units of 2^-64

    double fraction() const noexcept { return static_cast<double>(part >> 11U) * 0x1p-53; }
    void advance(StepPosition by) noexcept {
        part += by.part;
        step += by.step + (part < by.part ? 1 : 0);
    }
    /// n times this one, from 0.
    StepPosition times(std::int64_t n) const noexcept;
};

/// Whether the integration still stands.
enum class Status { running, unstable };

class Simulation {
   public:
    /// @param scene validated and resolved (numerics.hpp): integrator and step_s are set. @param most the largest wish
    /// that advance() will get. @throws std::invalid_argument if the scene is not resolved; std::bad_alloc
    Simulation(const Scene& scene, Wish most);

    /// Back to sample 0, at static equilibrium.
    void reset() noexcept;

    /// The next `count` samples (at most samples.capacity). Allocates nothing. If the step turns out to lie beyond the
    /// stability limit the block comes back empty, and failure() tells where and when.
    Status advance(Samples& samples, std::size_t count, Wish wish) noexcept;

    /// Passes over the next `count` samples: the motion goes on, nothing is put down.
    Status skip(std::int64_t count) noexcept;

    const Chain& chain() const noexcept { return chain_; }
    double step_s() const noexcept { return step_s_; }
    std::int64_t steps() const noexcept { return state_.step; }
    std::int64_t next_sample() const noexcept { return next_sample_; }
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
    void start_rows() noexcept;
    void run_until(std::int64_t step) noexcept;
    void begin_batch() noexcept;
    void fold_active() noexcept;
    void collect_ledger() noexcept;
    bool stable() noexcept;
    void drop_old_rows(std::size_t keep_from) noexcept;
    void emit(Samples& samples, std::size_t i, const double* from, const double* to, double span, double z) const noexcept;
    void emit_ready(Samples* samples, std::int64_t end) noexcept;
    Status produce(Samples* samples, std::int64_t count) noexcept;

    Chain chain_;
    Integrator integrator_;
    double step_s_;
    int grid_;  ///< steps per sample when that is a whole number; 0: samples lie between steps
    StepPosition sample_period_;  ///< in steps
    Wish most_;
    ToneBurst burst_;
    ChainState state_;
    FoldedChain folded_;
    Kernel kernel_ = nullptr;
    std::vector<HornStep> horn_;
    std::int64_t horn_first_ = -1;
    Eigen::Index front_ = 0;  ///< bodies from here on are still at rest, exactly
    std::vector<double> rows_, fractions_;
    std::vector<std::int64_t> row_steps_;
    Trace trace_;
    std::int64_t next_sample_ = 0;
    StepPosition next_position_;  ///< of that sample
    Ledger ledger_;
    Status status_ = Status::running;
};

}  // namespace hertzline
