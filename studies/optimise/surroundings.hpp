#pragma once
// What lies around a point that a search found: a best point on the edge of a jump is of no use in a laboratory.

#include <cstdint>
#include <vector>

#include "studies/optimise/evaluations.hpp"
#include "studies/optimise/search_space.hpp"

namespace hertzline::studies {

/// A point beside another one.
struct Neighbour {
    std::size_t key = 0;
    double change = 0;  ///< -0.01: one per cent less; of a whole number -1: one less
    std::int64_t evaluation = Evaluations::none;
};

/// A feasible point and what lies around it. Neighbours beyond a range are left out.
struct Surroundings {
    std::int64_t centre = Evaluations::none;
    std::vector<Neighbour> near;  ///< 1 % in each key that is a number
    std::vector<Neighbour> far;   ///< 5 %, and one more and less of whole numbers

    /// The worst of the centre and `near`, by merit.
    std::int64_t worst(const Evaluations& evaluations) const noexcept;
};

/// Evaluations that it takes at most to look around what a search found.
std::int64_t evaluations_around(const SearchSpace& space) noexcept;

/// The other places that a search looks around beside the best.
inline constexpr std::size_t other_places = 2;

/// The best of all evaluations and what lies around it. Where a neighbour is better it goes on from there, a few times; the last
/// better one has no neighbours.
Surroundings around_best(const SearchSpace& space, Evaluations& evaluations);

/// A point and what is near it.
Surroundings around(const SearchSpace& space, Evaluations& evaluations, std::int64_t centre);

}  // namespace hertzline::studies
