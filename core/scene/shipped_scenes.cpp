// shipped_scenes() itself is written by cmake/EmbedScenes.cmake.

#include <algorithm>

#include "hertzline/scene_file.hpp"

namespace hertzline {

const ShippedScene* find_shipped_scene(std::string_view name) noexcept {
    const auto scenes = shipped_scenes();
    const auto found =
        std::find_if(scenes.begin(), scenes.end(), [&](const auto& scene) { return scene.name == name; });
    return found != scenes.end() ? &*found : nullptr;
}

}  // namespace hertzline
