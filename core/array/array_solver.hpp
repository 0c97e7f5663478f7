#pragma once
// Integrates the chains of an array, each by a solver of its own. Chains that are alike move alike where their discs do not feel each
// other, each after the delay of its drive: one of them is simulated, and heard from all of their places.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/array/team.hpp"
#include "core/array/water.hpp"
#include "core/model/chain.hpp"
#include "core/solvers/delayed_chains.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/solvers/solver.hpp"
#include "hertzline/samples.hpp"

namespace hertzline {

/// The scene of a chain to be simulated, and the elements that it stands for.
struct ArrayMember {
    struct Element {
        std::size_t number;  ///< from 0 on
        double delay_s;      ///< behind the chain itself
    };
    Scene scene;
    std::vector<Element> elements;
};
std::vector<ArrayMember> array_members(const Scene& scene);

class ArraySolver final : public Solver {
public:
    /// @throws std::bad_alloc
    ArraySolver(const ResolvedScene& resolved, const SimulationOptions& options);

    void reset() noexcept override;
    Status produce(Samples* samples, std::int64_t count) noexcept override;
    std::int64_t next_sample() const noexcept override { return next_sample_; }
    // the motion of an array is not handed over
    std::int64_t first_open_sample() const noexcept override { return next_sample_; }
    void end_at(std::int64_t sample) noexcept override;
    Status reach_end() noexcept override { return Status::running; }
    Motion motion() noexcept override { return members_.front()->solver->motion(); }
    void begin_with(const Motion& motion) noexcept override;
    std::int64_t steps() noexcept override;
    std::int64_t contact_events() const noexcept override;
    const ChainState& state(std::size_t element) noexcept override;
    const Chain& chain(std::size_t element) const noexcept override;
    double time_s() const noexcept override { return members_.front()->solver->time_s(); }
    Ledger ledger() noexcept override;
    Energy energy() noexcept override;
    double fit_error() const noexcept override;
    std::string failure() const override;

    /// Bytes, roughly from above. @param taps that the scene has
    static double memory_bytes(const Scene& scene, TapSet taps);

    /// The water between the discs; null where they do not feel each other.
    const Water* water() const noexcept { return water_.get(); }

private:
    ArraySolver(const ResolvedScene& resolved, const SimulationOptions& options,
                std::vector<ArrayMember> members);

    /// A chain, and the elements that it stands for.
    struct Member {
        std::vector<ArrayMember::Element> elements;
        ResolvedScene scene;
        std::unique_ptr<const Chain> chain;
        std::unique_ptr<SeriesSolver> solver;
        Samples block;                           ///< samples that are still to be put together
        std::unique_ptr<DelayedChains> delayed;  ///< null: all elements move together
        Status status = Status::running;
    };
    /// Where an element's samples are.
    struct Place {
        std::size_t member;
        std::optional<std::size_t> delayed;  ///< number among the member's; none: the chain itself
    };

    Status advance(std::int64_t count, TapSet wanted) noexcept;
    Status advance_together(std::int64_t until) noexcept;
    Status worst() const noexcept;
    void put(Samples& samples, std::int64_t count) noexcept;
    void ask_delayed(TapSet wanted) noexcept;
    const Samples& block_of(std::size_t element) const noexcept;
    const DelayedChains::Account* account_of(std::size_t element) const noexcept;
    double from_water(Tap tap, std::size_t channel, std::int64_t sample) const noexcept;

    SimulationOptions options_;
    std::vector<std::unique_ptr<Member>> members_;
    std::vector<Place> places_;  ///< by elements
    /// Taps that delayed chains were not asked for when their samples ahead were put, and the first sample that has them again.
    TapSet missing_;
    std::int64_t missing_until_ = 0;
    std::unique_ptr<Water> water_;
    bool has_axis_ = false;  ///< the pressure at the hydrophone is the first of the water's
    Team team_;
    std::int64_t next_sample_ = 0;
};

/// Warnings of an array: discs that feel each other more than the scene wants to know, a fluid that gives energy by the errors of its
/// tables. A sentence each. @param scene resolved. @throws std::bad_alloc
std::vector<std::string> array_warnings(const Scene& scene);

}  // namespace hertzline
