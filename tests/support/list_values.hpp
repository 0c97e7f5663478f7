#pragma once
// Values of keys that are lists.

#include <vector>

#include "core/scene/scene_key.hpp"

namespace hertzline::test {

/// Returns that value of a key, or, of a list, the shortest of at least two entries that holds nothing else.
inline SceneValue filled_with(const SceneKey& key, const SceneValue& one) {
    if (!key.is_list()) {
        return one;
    }
    const std::size_t count = std::max<std::size_t>(2, key.counts.front().least);
    return joined(key, std::vector<SceneValue>(count, filled_with(key.entry(0), one)));
}

}  // namespace hertzline::test
