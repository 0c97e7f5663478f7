#pragma once
// Where a search looks: the ranges and lists of its keys, as a cube whose sides are 1 long.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "studies/sweep/axis.hpp"

namespace hertzline::studies {

/// A number from 0 to 1 for each key: its place in the range, or which element of the list (Axis::at).
using Place = std::vector<double>;

class SearchSpace {
public:
    explicit SearchSpace(std::vector<Axis> axes);

    const std::vector<Axis>& axes() const noexcept { return axes_; }
    std::size_t keys() const noexcept { return axes_.size(); }

    /// Keys that have a range, by their numbers: a local search moves these alone.
    const std::vector<std::size_t>& ranges() const noexcept { return ranges_; }

    /// What the keys are at a place.
    std::vector<SceneValue> values(const Place& place) const;

    /// The place with other numbers for the keys that have a range.
    Place moved(const Place& place, std::span<const double> of_ranges) const;
    std::vector<double> of_ranges(const Place& place) const;

    /// Between places of equal words, in sides of the cube; infinite between others.
    double distance(const Place& a, const Place& b) const noexcept;

    /// The values with a key changed by that share of itself; nothing where it has no range of numbers or would leave it.
    std::optional<std::vector<SceneValue>> nudged(const std::vector<SceneValue>& values, std::size_t key,
                                                  double share) const;
    /// The values with a whole number changed by one; nothing where it is none or would leave its range.
    std::optional<std::vector<SceneValue>> stepped(const std::vector<SceneValue>& values, std::size_t key,
                                                   int step) const;

private:
    std::vector<Axis> axes_;
    std::vector<std::size_t> ranges_;
};

}  // namespace hertzline::studies
