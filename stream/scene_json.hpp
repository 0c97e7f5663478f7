#pragma once
// A scene as a JSON object, section by section, for messages and summaries.

#include <nlohmann/json.hpp>

#include "core/scene/scene.hpp"

namespace hertzline::stream {

/// {"drive": {"material": "steel", ...}, ...}; unset members are null, materials that are the scene's own in "materials".
nlohmann::ordered_json scene_json(const Scene& scene);

}  // namespace hertzline::stream
