#pragma once

#include <optional>
#include <string>

#include "core/scene/json.hpp"

namespace hertzline::scope {

/// The scene in a stream's meta as a scene file; nothing when it holds none that this program knows.
std::optional<std::string> scene_text(const Json& meta);

}  // namespace hertzline::scope
