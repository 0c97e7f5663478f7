#pragma once
// A key and its values in a study, as one --vary option gives them.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/scene_key.hpp"

namespace hertzline::studies {

/// The most points of a sweep.
inline constexpr std::int64_t max_points = 100'000'000;

/// The most faults that an axis of values or a list of points reports.
inline constexpr std::size_t max_faults = 12;

/// The spacing of the values of a range.
enum class Spacing { linear, logarithmic };

/// The sampling of an axis: as a grid, value by value, or anywhere in its range.
enum class Sampling { grid, anywhere };

/// A key and its values: a range, or a list.
struct Axis {
    SceneKey key;
    std::vector<SceneValue> list;  ///< empty: a range
    double from = 0;
    double to = 0;
    Spacing spacing = Spacing::linear;
    std::int64_t count = 0;  ///< of the values in a grid

    /// Returns a value of the grid, 0 to count - 1. Both ends of a range are exact.
    SceneValue value(std::int64_t number) const;

    /// Returns the value at a position in the range, from 0 to 1 without 1. Elements of a list have equal shares.
    SceneValue at(double position) const;
    /// Returns the index of the list's element there.
    std::size_t element_at(double position) const noexcept;

    /// Returns the position of a value in the range.
    double position(const SceneValue& value) const;

    /// Returns the canonical text, "chain.preload_n=0.01..10:log:40".
    std::string text() const;
};

/// The key of that name with single values, or its fault: a list varies entry by entry, as end.thicknesses_m[2].
tl::expected<SceneKey, Fault> varied_key(const Scene& scene, std::string_view name);

/// Reads "KEY=FROM..TO:COUNT[:lin|log]" or "KEY=A,B,C"; the spacing may also stand before the count.
/// With Sampling::anywhere a range has no count.
/// @param scene the base scene: each value must be allowed for its key by itself
/// @returns the axis or every fault, each with the option as its place
tl::expected<Axis, std::vector<Fault>> parse_axis(const Scene& scene, std::string_view option,
                                                  Sampling sampling);

/// Returns a value as TOML has it in a setting, "KEY=VALUE": ".5" becomes "0.5".
std::string setting_of(std::string_view key, std::string_view value);

/// Returns the first value of such an option as a setting, "KEY=FROM" or "KEY=A". The key may be none of the scene.
std::string first_setting(std::string_view option);

/// Reads the values of a key, as they stand in such an option behind "KEY=". Faults have no place.
tl::expected<Axis, std::vector<Fault>> parse_values(const Scene& scene, SceneKey key, std::string_view text,
                                                    Sampling sampling);

/// Makes an axis of the values, at least one. @returns the axis or every fault
tl::expected<Axis, std::vector<Fault>> axis_of(const Scene& scene, std::string_view key,
                                               std::span<const SceneValue> values);

/// Returns a random number, or one of a Sobol sequence, as a fraction from 0 to 1 without 1.
double unit_fraction(std::uint64_t number) noexcept;

}  // namespace hertzline::studies
