#pragma once
// What one --vary option says: a key and the values that it takes.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/scene_key.hpp"

namespace hertzline::studies {

/// A sweep has at most so many points.
inline constexpr std::int64_t max_points = 100'000'000;

/// Faults of the values of one axis or one list of points: more are not reported.
inline constexpr std::size_t max_faults = 12;

/// How the values of a range lie.
enum class Spacing { linear, logarithmic };

/// How an axis is sampled: as a grid, value by value, or anywhere in its range.
enum class Sampling { grid, anywhere };

/// A key and its values: a range, or a list.
struct Axis {
    SceneKey key;
    std::vector<SceneValue> list;  ///< empty: a range
    double from = 0;
    double to = 0;
    Spacing spacing = Spacing::linear;
    std::int64_t count = 0;  ///< of values in a grid

    /// The value of that number in a grid, 0 to count - 1. Both ends of a range are exact.
    SceneValue value(std::int64_t number) const;

    /// The value at a place in the range, from 0 to 1 without 1; of a list the one whose share that is.
    SceneValue at(double place) const;

    /// "chain.preload_n=0.01..10:log:40": the same for equal axes.
    std::string text() const;
};

/// Reads "KEY=FROM..TO:COUNT[:lin|log]" or "KEY=A,B,C"; the spacing may also stand before the count.
/// With Sampling::anywhere a range has no count.
/// @param scene what is varied: each value must be allowed for its key, whatever the other keys say
/// @returns the axis or every fault, each with the option as its place
tl::expected<Axis, std::vector<Fault>> parse_axis(const Scene& scene, std::string_view option,
                                                  Sampling sampling);

/// Makes an axis of the values, at least one. @returns the axis or every fault
tl::expected<Axis, std::vector<Fault>> axis_of(const Scene& scene, std::string_view key,
                                               std::span<const SceneValue> values);

/// A random number, or one of a Sobol sequence, as a place from 0 to 1 without 1.
double place_of(std::uint64_t number) noexcept;

}  // namespace hertzline::studies
