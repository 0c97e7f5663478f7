#pragma once
// Chains that move as another one does, each some time later: their samples, and their accounts of energy. They need no pieces of their own.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/model/chain.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/sampling/contact_forces.hpp"
#include "core/solvers/sampling/end_taps.hpp"
#include "core/solvers/sampling/plate_outputs.hpp"
#include "core/solvers/solver.hpp"
#include "hertzline/samples.hpp"

namespace hertzline {

class DelayedChains {
public:
    /// The energy of the leading chain at the end of a piece, and the events of its contacts so far.
    struct Account {
        FixedTime at;  ///< [samples]
        Ledger ledger;
        Solver::Energy energy;
        std::int64_t contact_events = 0;
    };

    /// @param chain the leading one, which outlives the object @param scene its own
    /// @param delays_s of the others' drives behind its own, positive @param samples_ahead that are to be put before any is taken
    DelayedChains(const Chain& chain, const Scene& scene, const std::vector<double>& delays_s,
                  const SimulationOptions& options, std::size_t samples_ahead);

    /// The longest delay of a chain that is not simulated itself [samples].
    static constexpr double longest = 4096;

    /// Back to sample 0. @param rest the account there
    void reset(const Account& rest) noexcept;

    std::size_t size() const noexcept { return chains_.size(); }
    /// The samples of a chain that are there, to be taken from the front.
    Samples& block(std::size_t chain) noexcept { return chains_[chain]->block; }
    const Samples& block(std::size_t chain) const noexcept { return chains_[chain]->block; }

    /// Puts down the samples before `until` that show a piece of the leading chain. Samples before its begin show it as it begins: at rest.
    /// @param put of some samples: takes writer, contact forces, piece, number of the first one and how many, and returns how many
    template <class Put>
    void put(const Stretch& piece, std::int64_t until, const Put& put) noexcept {
        for (const auto& chain : chains_) {
            Stretch later = piece;
            later.begin.advance(chain->delay);
            later.end.advance(chain->delay);
            Samples& block = chain->block;
            std::int64_t next = block.first + static_cast<std::int64_t>(block.count);
            const std::int64_t end = std::min(until, later.end.rounded_up());
            if (block.holds.empty() || next >= end) {
                block.count += static_cast<std::size_t>(std::max<std::int64_t>(0, end - next));
                continue;
            }
            EndTapsWriter writer(chain->end_taps, block);
            while (next < end) {
                const std::int64_t begin = later.begin.rounded_up();
                next += put(writer, chain->contact_forces, later, next,
                            (next < begin ? std::min(begin, end) : end) - next);
            }
        }
    }

    /// A piece of the leading chain is done.
    void note(const Account& account) noexcept;
    /// The account of a chain after `samples`; null: that of the leading chain. Exact to a piece, as its own is.
    const Account* account(std::size_t chain, std::int64_t samples) const noexcept;

private:
    struct Delayed {
        Delayed(const Chain& chain, const Scene& scene, const SimulationOptions& options,
                double delay_samples, std::size_t room);
        FixedTime delay;  ///< [samples]
        EndTaps end_taps;
        ContactForces contact_forces;
        Samples block;
    };

    std::vector<std::unique_ptr<Delayed>> chains_;
    Account rest_;
    std::vector<Account> accounts_;  ///< by samples: the last one whose time begins with that number
};

}  // namespace hertzline
