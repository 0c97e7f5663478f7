#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "core/scene/scene_fields.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

using fields::Key;

// TOML tells 5 from 5.0; a number is written as a float so that a reader of any kind sees its type.
std::string toml_text(double value) {
    const std::string text = number_text(value == 0 ? 0.0 : value);  // -0 equals 0: one text for both
    return text.find_first_of(".eni") == std::string::npos ? text + ".0" : text;  // n, i: nan, inf
}

std::string toml_text(std::int64_t value) {
    return number_text(value);
}

std::string toml_text(const std::string& value) {
    return hertzline::quoted(value);
}

template <class Choice>
requires std::is_enum_v<Choice> std::string toml_text(Choice value) {
    return quoted(word(value));
}

/// Keys that a hash is taken without where they have their defaults: the hash of a scene that knows nothing of modal plates and
/// damping laws stays what it was before there were such.
constexpr std::array<std::string_view, 6> unhashed_defaults{
    "chain.damping_law", "end.model", "end.modes", "end.loss_factor", "medium.load", "output.hydrophone_m"};

// Visits the fields and writes each; a section's heading comes before its first key.
struct Writer {
    std::string text;
    std::string section;
    std::vector<SceneKey> left_out;  ///< where they have these values

    template <class Member, class Allowed>
    void operator()(const Key& key, const std::optional<Member>& member, const Allowed& allowed) {
        if (member) {
            (*this)(key, *member, allowed);
        }
    }
    template <class Member, class Allowed>
    void operator()(const Key& key, const Member& member, const Allowed& /*allowed*/) {
        if (is_left_out(key.text(), toml_text(member))) {
            return;
        }
        if (key.section != section) {
            section = key.section;
            text += (text.empty() ? "[" : "\n[") + section + "]\n";
        }
        text += std::string(key.name) + " = " + toml_text(member) + '\n';
    }

    bool is_left_out(const std::string& key, const std::string& value) const {
        return std::any_of(left_out.begin(), left_out.end(), [&](const SceneKey& other) {
            return other.key == key && other.default_value == value;
        });
    }
};

// Visits the fields of a default scene and lists them.
struct Lister {
    std::vector<SceneKey>& keys;

    template <class Member, class Allowed>
    void operator()(const Key& key, const std::optional<Member>& member, const Allowed& allowed) const {
        keys.push_back({key.text(), member ? toml_text(*member) : "", allowed_text(allowed)});
    }
    template <class Member, class Allowed>
    void operator()(const Key& key, const Member& member, const Allowed& allowed) const {
        keys.push_back({key.text(), toml_text(member), allowed_text(allowed)});
    }
};

std::string scene_text(const Scene& scene, std::vector<SceneKey> left_out) {
    Writer write{"", "", std::move(left_out)};
    fields::visit_scene(scene, write);
    for (const auto& [name, material] : scene.materials) {
        const std::string section = "materials." + key_part(name);
        if (const auto* solid = std::get_if<Solid>(&material)) {
            fields::visit_solid(*solid, section, write);
        } else {
            fields::visit_fluid(std::get<Fluid>(material), section, write);
        }
    }
    return std::move(write.text);
}

std::string hashed_text(const Scene& scene) {
    std::vector<SceneKey> left_out = scene_keys();
    std::erase_if(left_out, [](const SceneKey& key) {
        return std::find(unhashed_defaults.begin(), unhashed_defaults.end(), key.key) ==
               unhashed_defaults.end();
    });
    return scene_text(scene, std::move(left_out));
}

}  // namespace

std::string to_toml(const Scene& scene) {
    return scene_text(scene, {});
}

std::string scene_hash(const Scene& scene) {
    // Constants: http://www.isthe.com/chongo/tech/comp/fnv/ (Fowler, Noll, Vo).
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const char c : hashed_text(scene)) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3;
    }
    constexpr std::string_view hex = "0123456789abcdef";
    std::string digits;
    for (int shift = 60; shift >= 0; shift -= 4) {
        digits += hex[(hash >> shift) & 0xF];
    }
    return digits;
}

std::vector<SceneKey> scene_keys() {
    std::vector<SceneKey> keys;
    const Scene defaults;
    fields::visit_scene(defaults, Lister{keys});
    return keys;
}

std::vector<SceneKey> material_keys() {
    std::vector<SceneKey> keys;
    const auto add = [&](const Key& key, const auto& /*member*/, const auto& allowed) {
        const std::string text = key.text();
        if (std::none_of(keys.begin(), keys.end(), [&](const auto& other) { return other.key == text; })) {
            keys.push_back({text, "", allowed_text(allowed)});
        }
    };
    const Solid solid;
    fields::visit_solid(solid, "materials.NAME", add);
    const Fluid fluid;
    fields::visit_fluid(fluid, "materials.NAME", add);
    return keys;
}

}  // namespace hertzline
