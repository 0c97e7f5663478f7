#pragma once
// The search itself: a global sample, local searches from the best of its points, more samples, and a look around what was found.
//
// It is multi-level single linkage with a low-discrepancy sequence (A. H. G. Rinnooy Kan and G. T. Timmer, Math. Programming 39 (1987) 57;
// S. Kucherenko and Y. Sytsko, Comput. Optim. Appl. 30 (2005) 297), which NLopt calls MLSL_LDS, in batches: a level's sample is one batch,
// and its local searches advance at once, so that each batch has a point of each of them.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studies/optimise/evaluations.hpp"
#include "studies/optimise/search_space.hpp"
#include "studies/optimise/surroundings.hpp"

namespace hertzline::studies {

/// A local search: where it began and the best that it came to, as numbers of evaluations.
struct SearchStart {
    std::int64_t from = Evaluations::none;
    std::int64_t best = Evaluations::none;
    Place place;         ///< of the best
    bool ended = false;  ///< by itself, not for want of evaluations
};

struct SearchResult {
    std::vector<SearchStart> starts;   ///< in the order in which they began
    Surroundings best;                 ///< the centre is `none` when no point is feasible
    std::vector<Surroundings> others;  ///< the best of what local searches found elsewhere; without `far`
};

inline constexpr std::int64_t most_evaluations = 1'000'000;

/// Returns the fewest evaluations that a search needs.
std::int64_t fewest_evaluations(const SearchSpace& space) noexcept;

/// Returns the fault of a number of evaluations in this space.
std::optional<std::string> evaluations_fault(std::int64_t evaluations, const SearchSpace& space);

/// Searches until the budget is used up, nothing new is left, or the user stops it (evaluations.stopped()). What it looks at hangs on
/// the space, the seed, the budget and the scores alone.
SearchResult search(const SearchSpace& space, Evaluations& evaluations, std::uint64_t seed);

/// Two points are elsewhere from each other when they lie farther apart [sides of the cube].
inline constexpr double elsewhere = 0.05;

}  // namespace hertzline::studies
