#include "scope/server/scene_text.hpp"

#include <vector>

#include "core/scene/json.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/text.hpp"

namespace hertzline::scope {

namespace {

/// What stands in the object, as --set takes it.
void append_settings(const Json& object, const std::string& above, std::vector<std::string>& settings) {
    for (const auto& [name, value] : object.items()) {
        const std::string key = above.empty() ? name : above + "." + key_part(name);
        if (value.is_object()) {
            append_settings(value, key, settings);
        } else if (value.is_string()) {
            settings.push_back(key + "=" + hertzline::quoted(value.get<std::string>()));
        } else if (!value.is_null()) {
            settings.push_back(key + "=" + value.dump());
        }
    }
}

}  // namespace

std::optional<std::string> scene_text(const Json& meta) {
    const auto scene = meta.is_object() ? meta.find("scene") : meta.end();
    if (!meta.is_object() || scene == meta.end() || !scene->is_object()) {
        return std::nullopt;
    }
    std::vector<std::string> settings;
    append_settings(*scene, "", settings);
    const auto parsed = parse_scene("", "meta", settings);
    return parsed ? std::optional("# The scene of a stream, saved by hertzline scope.\n" +
                                  to_toml(parsed->scene))
                  : std::nullopt;
}

}  // namespace hertzline::scope
