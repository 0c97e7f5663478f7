#pragma once
// Integrates on a grid of equal steps, with the kernels of leapfrog and chin4a. Only the part of the chain
// that the wave has reached is worked on.

#include <vector>

#include "core/integrators/kernels.hpp"
#include "core/integrators/simd_chain.hpp"
#include "core/model/horn.hpp"
#include "core/solvers/sampling/sampler.hpp"
#include "core/solvers/solver.hpp"

namespace hertzline {

class SteppedSolver final : public Solver {
public:
    SteppedSolver(const ResolvedScene& resolved, const Chain& chain, const SimulationOptions& options);

    void reset() noexcept override;
    Status produce(Samples* samples, std::int64_t count) noexcept override;
    std::int64_t next_sample() const noexcept override { return sampler_.next_sample(); }
    std::int64_t first_open_sample() const noexcept override;
    void end_at(std::int64_t sample) noexcept override { last_sample_ = sample; }
    Status reach_end() noexcept override;
    Motion motion() noexcept override;
    void begin_with(const Motion& motion) noexcept override;
    std::int64_t contact_events() const noexcept override { return simd_chain_.contact_events; }
    std::int64_t steps() noexcept override { return state_.step; }
    const ChainState& state(std::size_t element) noexcept override;
    const Chain& chain(std::size_t /*element*/) const noexcept override { return chain_; }
    double time_s() const noexcept override { return static_cast<double>(state_.step) * step_s_; }
    Ledger ledger() noexcept override;
    Energy energy() noexcept override;
    std::string failure() const override;

    static double memory_bytes(double bodies, TapSet taps) noexcept;

private:
    double horn_displacement() const noexcept;
    void run_until(std::int64_t step, kernels::Trace& trace) noexcept;
    int take_steps(int count, kernels::Trace& trace) noexcept;
    void take_in_parts(kernels::Trace& trace) noexcept;
    void begin_batch() noexcept;
    void load_active() noexcept;
    void lay_out(Eigen::Index active) noexcept;
    void collect_ledger() noexcept;
    bool stable() noexcept;
    void watch_from(double overlap) noexcept;

    const Chain& chain_;
    Integrator integrator_;
    double step_s_;
    SimulationOptions options_;
    double limit_at_rest_;  ///< largest stable step of the chain at rest [s]
    std::unique_ptr<Horn> horn_;
    ChainState state_;
    kernels::SimdChain simd_chain_;
    kernels::Kernel kernel_ = nullptr;
    std::vector<HornStep> horn_steps_;
    std::int64_t horn_first_ = -1;
    Eigen::Index front_ = 0;  ///< bodies from here on are still at rest, exactly
    Sampler sampler_;
    Ledger ledger_;
    std::int64_t last_sample_ = 0;  ///< where the motion is to be handed over
    Status status_ = Status::running;
};

}  // namespace hertzline
