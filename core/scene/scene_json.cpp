#include "core/scene/scene_json.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/scene/json.hpp"
#include "core/scene/scene_fields.hpp"
#include "core/scene/scene_words.hpp"

namespace hertzline {

namespace {

struct ToJson {
    Json& scene;

    template <class Member, class Allowed>
    void operator()(const fields::Key& key, const Member& member, const Allowed&) const {
        scene[std::string(key.section)][std::string(key.name)] = value(member);
    }

    template <class T>
    static Json value(const T& member) {
        if constexpr (std::is_enum_v<T>) {
            return word(member);
        } else {
            return member;
        }
    }
    template <class T>
    static Json value(const std::optional<T>& member) {
        return member ? value(*member) : Json(nullptr);
    }
};

Json material_json(const Material& material) {
    Json json = Json::object();
    const auto add = [&](const fields::Key& key, const std::optional<double>& number, const auto&) {
        if (number) {
            json[std::string(key.name)] = *number;
        }
    };
    if (const auto* solid = std::get_if<Solid>(&material)) {
        fields::visit_solid(*solid, "materials", add);
    } else {
        fields::visit_fluid(std::get<Fluid>(material), "materials", add);
    }
    return json;
}

}  // namespace

Json scene_json(const Scene& scene) {
    Json json = Json::object();
    fields::visit_scene(scene, ToJson{json});
    for (const auto& [name, material] : scene.materials) {
        json["materials"][name] = material_json(material);
    }
    return json;
}

}  // namespace hertzline
