#include "scope/server/scene_text.hpp"

#include "core/scene/scene_json.hpp"
#include "core/scene/scene_toml.hpp"

namespace hertzline::scope {

std::optional<std::string> scene_text(const Json& meta) {
    const auto found = meta.is_object() ? meta.find("scene") : meta.end();
    if (!meta.is_object() || found == meta.end() || !found->is_object()) {
        return std::nullopt;
    }
    const auto scene = scene_of_json(*found);
    return scene && validate(*scene).empty()
               ? std::optional("# The scene of a stream, saved by hertzline scope.\n" + to_toml(*scene))
               : std::nullopt;
}

}  // namespace hertzline::scope
