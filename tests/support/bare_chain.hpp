#pragma once
// A chain on its own, behind a horn that rests: for tests that choose where its bodies start and how fast.

#include <algorithm>
#include <array>

#include "core/energy.hpp"
#include "core/integrators/folded_chain.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {

class BareChain {
public:
    /// @param scene with integrator and step
    explicit BareChain(const Scene& scene)
        : chain(scene),
          state(chain),
          integrator_(*scene.numerics.integrator),
          step_s_(*scene.numerics.step_s),
          burst_(silent(scene.drive), step_s_),
          folded_(chain, integrator_, kernel_lanes()) {
        folded_.step_s = step_s_;
    }

    /// Takes steps from `state`, whatever it was set to.
    void advance(std::int64_t steps) {
        close_where_touching();
        folded_.fold(chain, state, chain.bodies());
        Trace nothing;
        nothing.capacity = max_rows_per_step;
        nothing.bodies = chain.bodies();
        while (steps > 0) {
            const int count = static_cast<int>(std::min<std::int64_t>(steps, ToneBurst::batch_steps));
            kernel(integrator_, folded_.rows())(folded_, burst_, horn_.data(), state.step, count, nothing);
            state.step += count;
            steps -= count;
        }
        folded_.unfold(state);
        for (std::size_t s = 0; s < folded_.ledger_slots(); ++s) {
            lost += folded_.column(Column::lost)[s];
        }
    }

    double energy() const { return kinetic_energy(chain, state) + stored_energy(chain, state, 0); }
    double time_s() const { return static_cast<double>(state.step) * step_s_; }

    Chain chain;
    ChainState state;
    double lost = 0;  ///< in the dashpots so far [J]

private:
    static Drive silent(Drive drive) {
        drive.amplitude_m = 0;
        return drive;
    }
    void close_where_touching() {
        double left = 0;
        for (Eigen::Index b = 0; b < chain.bodies(); ++b) {
            state.closed[b] = chain.static_overlap[b] + left - state.x[b] > 0 ? 1 : 0;
            left = state.x[b];
        }
    }

    Integrator integrator_;
    double step_s_;
    ToneBurst burst_;
    FoldedChain folded_;
    std::array<HornStep, ToneBurst::batch_steps> horn_{};
};

}  // namespace hertzline::test
