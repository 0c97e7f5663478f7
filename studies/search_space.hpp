#pragma once
// The ranges and lists of a search, as a cube with sides of length 1; and the sequence of positions that samples it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <boost/random/sobol.hpp>

#include "studies/axis.hpp"

namespace hertzline::studies {

/// A number from 0 to 1 for each key: the position in its range, or in its list (Axis::at).
using Position = std::vector<double>;

class SearchSpace {
public:
    explicit SearchSpace(std::vector<Axis> axes);

    const std::vector<Axis>& axes() const noexcept { return axes_; }
    std::size_t keys() const noexcept { return axes_.size(); }

    /// Indices of the keys with a range, which local searches vary.
    const std::vector<std::size_t>& ranges() const noexcept { return ranges_; }

    /// Returns the values of the keys at a position.
    std::vector<SceneValue> values(const Position& position) const;

    /// Returns the position with other coordinates of the keys with a range.
    Position moved(const Position& position, std::span<const double> coordinates) const;
    std::vector<double> coordinates(const Position& position) const;

    /// Returns the distance in sides of the cube; infinite between different elements of a list.
    double distance(const Position& a, const Position& b) const noexcept;

    /// Returns the values with one key changed.
    /// @param change of a number relative to itself, of an integer absolute
    /// @returns nothing where the key has no range, or its value would leave it or stay the same
    std::optional<std::vector<SceneValue>> perturbed(const std::vector<SceneValue>& values, std::size_t key,
                                                     double change) const;

private:
    std::vector<Axis> axes_;
    std::vector<std::size_t> ranges_;
};

/// Sobol's sequence, which fills the cube more evenly than random positions. Each seed shifts it as a whole, modulo 1
/// (R. Cranley and T. N. L. Patterson, SIAM J. Numer. Anal. 13 (1976) 904).
class SampleSequence {
public:
    SampleSequence(std::size_t dimensions, std::uint64_t seed);

    Position next();

private:
    boost::random::sobol sequence_;
    std::vector<double> shifts_;
};

}  // namespace hertzline::studies
