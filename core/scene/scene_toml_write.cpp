#include <algorithm>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <utility>

#include "core/scene/scene_fields.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

// TOML tells 5 from 5.0; a number is written as a float so that a reader of any kind sees its type.
std::string toml_text(double value) {
    const std::string text = number_text(value == 0 ? 0.0 : value);  // -0 equals 0: one text for both
    return text.find_first_of(".eni") == std::string::npos ? text + ".0" : text;  // n, i: nan, inf
}

std::string toml_text(std::int64_t value) {
    return number_text(value);
}

std::string toml_text(const std::string& value) {
    return quoted(value);
}

template <class Choice>
requires std::is_enum_v<Choice> std::string toml_text(Choice value) {
    return quoted(word(value));
}

// Visits the fields and writes each; a section's heading comes before its first key.
struct Writer {
    std::string& text;
    std::string section;

    template <class Member, class Allowed>
    void operator()(std::string_view key, const std::optional<Member>& member, const Allowed& allowed) {
        if (member) {
            (*this)(key, *member, allowed);
        }
    }
    template <class Member, class Allowed>
    void operator()(std::string_view key, const Member& member, const Allowed& /*allowed*/) {
        const auto dot = key.find('.');  // none in the keys of a material: their heading is written already
        if (dot != std::string_view::npos && key.substr(0, dot) != section) {
            begin(std::string(key.substr(0, dot)));
        }
        text += std::string(key.substr(dot + 1)) + " = " + toml_text(member) + '\n';
    }
    void begin(std::string name) {
        section = std::move(name);
        text += (text.empty() ? "[" : "\n[") + section + "]\n";
    }
};

// Visits the fields of a default scene and lists them.
struct Lister {
    std::vector<SceneKey>& keys;
    std::string section;
    bool has_defaults;

    template <class Member, class Allowed>
    void operator()(std::string_view key, const std::optional<Member>& member, const Allowed& allowed) const {
        keys.push_back({section + std::string(key), member ? toml_text(*member) : "", allowed_text(allowed)});
    }
    template <class Member, class Allowed>
    void operator()(std::string_view key, const Member& member, const Allowed& allowed) const {
        keys.push_back(
            {section + std::string(key), has_defaults ? toml_text(member) : "", allowed_text(allowed)});
    }
};

}  // namespace

std::string to_toml(const Scene& scene) {
    std::string text;
    Writer write{text, ""};
    fields::visit_scene(scene, write);
    for (const auto& [name, material] : scene.materials) {
        write.begin("materials." + key_part(name));
        if (const auto* solid = std::get_if<Solid>(&material)) {
            fields::visit_solid(*solid, write);
        } else {
            fields::visit_fluid(std::get<Fluid>(material), write);
        }
    }
    return text;
}

std::string scene_hash(const Scene& scene) {
    // Constants: http://www.isthe.com/chongo/tech/comp/fnv/ (Fowler, Noll, Vo).
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const char c : to_toml(scene)) {
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
    fields::visit_scene(defaults, Lister{keys, "", true});
    return keys;
}

std::vector<SceneKey> material_keys() {
    constexpr auto section = "materials.NAME.";
    std::vector<SceneKey> keys;
    const Solid solid;
    fields::visit_solid(solid, Lister{keys, section, false});
    std::vector<SceneKey> fluid_keys;
    const Fluid fluid;
    fields::visit_fluid(fluid, Lister{fluid_keys, section, false});
    std::copy_if(fluid_keys.begin(), fluid_keys.end(), std::back_inserter(keys), [&](const SceneKey& own) {
        return std::none_of(keys.begin(), keys.end(),
                            [&](const SceneKey& other) { return other.key == own.key; });
    });
    return keys;
}

}  // namespace hertzline
