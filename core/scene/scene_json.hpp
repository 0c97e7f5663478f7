#pragma once
// A scene as a JSON object, section by section, for messages and summaries.

#include "core/scene/json.hpp"
#include "core/scene/scene.hpp"

namespace hertzline {

/// {"drive": {"material": "steel", ...}, ...}; unset members are null, materials that are the scene's own in "materials".
Json scene_json(const Scene& scene);

}  // namespace hertzline
