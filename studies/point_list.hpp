#pragma once
// A list of points, as a CSV has them: a line of keys, then a line of values for each point.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/scene_key.hpp"

namespace hertzline::studies {

/// Points and the keys that vary.
struct PointList {
    std::vector<SceneKey> keys;
    std::vector<SceneValue> values;  ///< point by point
    std::string text = {};           ///< the CSV

    std::size_t size() const noexcept { return values.size() / keys.size(); }
    const SceneValue& value(std::size_t point, std::size_t key) const {
        return values[point * keys.size() + key];
    }
};

/// A key and its value at each point.
struct PointColumn {
    std::string key;
    std::vector<SceneValue> values;
};

/// Reads the text of a CSV, or of a table of sweep, whose keys stand between "point" and "status". Cells may be quoted. Each value must
/// be allowed for its key by itself.
/// @param scene the base scene @param origin name of the file in messages
/// @returns the points, at least one, or the first dozen faults with their lines
tl::expected<PointList, std::vector<Fault>> parse_points(const Scene& scene, std::string_view text,
                                                         std::string_view origin);

/// Returns the first point of a CSV as settings, "KEY=VALUE". The keys may be none of the scene.
std::vector<std::string> first_settings(std::string_view text);

/// Makes a list of the columns, which are equally long.
/// @returns the points, or the first dozen faults
tl::expected<PointList, std::vector<Fault>> points_of(const Scene& scene,
                                                      std::span<const PointColumn> columns);

}  // namespace hertzline::studies
