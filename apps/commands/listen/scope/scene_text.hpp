#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace hertzline::app {

/// The scene in a stream's meta as a scene file; nothing when it holds none that this program knows.
std::optional<std::string> scene_text(const nlohmann::ordered_json& meta);

}  // namespace hertzline::app
