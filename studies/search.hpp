#pragma once
// The search for the best point: a global sample, local searches from its best points, larger samples, and then the neighbourhood
// of the best.
//
// It is multi-level single linkage with a low-discrepancy sequence (A. H. G. Rinnooy Kan and G. T. Timmer, Math. Programming 39 (1987) 57;
// S. Kucherenko and Y. Sytsko, Comput. Optim. Appl. 30 (2005) 297), which NLopt calls MLSL_LDS, in batches: a level's sample is one batch,
// and its local searches advance together, so that each batch has a point of each of them.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/goal.hpp"
#include "studies/search_space.hpp"

namespace hertzline::studies {

/// Runs points and returns their scores in the same order, or nothing once the user stops the search. Errors are exceptions.
using Evaluate =
    std::function<std::optional<std::vector<Score>>(std::span<const std::vector<SceneValue>> points)>;

/// The points that a search has evaluated: each once, in batches, within a budget.
class Evaluations {
public:
    struct Evaluation {
        std::vector<SceneValue> values;
        Score score;
        double merit = 0;  ///< merit_of()
    };

    /// @param budget the most evaluations
    Evaluations(bool maximise, std::int64_t budget, Evaluate evaluate);

    static constexpr std::int64_t none = -1;

    /// Evaluates new points as one batch. @returns the number of each point; `none` beyond the budget
    std::vector<std::int64_t> run(std::span<const std::vector<SceneValue>> points);

    /// Adds a point whose score is known.
    void add(std::vector<SceneValue> values, const Score& score);

    /// Returns the number of a point; `none` before it is evaluated.
    std::int64_t find(const std::vector<SceneValue>& values) const;

    const Evaluation& operator[](std::int64_t number) const { return all_[static_cast<std::size_t>(number)]; }
    const std::vector<Evaluation>& all() const noexcept { return all_; }
    std::int64_t size() const noexcept { return static_cast<std::int64_t>(all_.size()); }
    std::int64_t left() const noexcept { return stopped_ ? 0 : budget_ - reserved_ - size(); }
    /// Keeps a part of the budget for later.
    void reserve(std::int64_t evaluations) noexcept { reserved_ = evaluations; }
    bool stopped() const noexcept { return stopped_; }

    /// Returns the first feasible point of the least merit; `none` without a feasible point.
    std::int64_t best() const noexcept;

private:
    bool maximise_;
    std::int64_t budget_;
    std::int64_t reserved_ = 0;
    Evaluate evaluate_;
    std::vector<Evaluation> all_;
    std::map<std::vector<SceneValue>, std::int64_t> numbers_;
    bool stopped_ = false;
};

/// A local search: its start and the best point that it reached, as numbers of evaluations.
struct SearchStart {
    std::int64_t from = Evaluations::none;
    std::int64_t best = Evaluations::none;
    Position position;   ///< of the best point
    bool ended = false;  ///< it converged before the budget was used up
};

/// A point with one key changed.
struct Neighbour {
    std::size_t key = 0;
    double change = 0;  ///< as in SearchSpace::perturbed()
    std::int64_t evaluation = Evaluations::none;
};

/// The neighbourhood of a feasible point: a maximum on the edge of a jump is of no use in a laboratory. Neighbours outside of a
/// range are left out.
struct Sensitivity {
    std::int64_t centre = Evaluations::none;
    std::vector<Neighbour> near;  ///< 1 % in each number
    std::vector<Neighbour> far;   ///< 5 % in each number, 1 in each integer

    /// Returns the worst of the centre and `near`, by merit.
    std::int64_t worst(const Evaluations& evaluations) const noexcept;
};

struct SearchResult {
    std::vector<SearchStart> starts;  ///< in their order
    Sensitivity best;                 ///< the centre is `none` when no point is feasible
    std::vector<Sensitivity> others;  ///< the best points of other regions; without `far`
};

inline constexpr std::int64_t most_evaluations = 1'000'000;

/// Returns the fewest evaluations that a search needs.
std::int64_t fewest_evaluations(const SearchSpace& space) noexcept;

/// Returns the fault of a number of evaluations in this space.
std::optional<std::string> evaluations_fault(std::int64_t evaluations, const SearchSpace& space);

/// Searches until the budget is used up, all points are evaluated, or the user stops it (evaluations.stopped()). The points depend only
/// on the space, the seed, the budget and the scores.
SearchResult search(const SearchSpace& space, Evaluations& evaluations, std::uint64_t seed);

}  // namespace hertzline::studies
