#include "core/scene/scene_toml.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "core/scene/scene_fields.hpp"
#include "core/scene/scene_settings.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

using fields::Count;
using fields::MaterialSort;
using fields::OneOf;
using fields::Range;

// The value as the type that the field wants; whether the value itself is allowed is for validate() to say.
std::optional<double> read(const TomlValue& value, const Range& /*range*/) {
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
        return static_cast<double>(*integer);
    }
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? std::optional(*number) : std::nullopt;
}

std::optional<std::int64_t> read(const TomlValue& value, const Count& /*count*/) {
    const auto* integer = std::get_if<std::int64_t>(&value);
    return integer != nullptr ? std::optional(*integer) : std::nullopt;
}

std::optional<std::string> read(const TomlValue& value, MaterialSort /*sort*/) {
    const auto* name = std::get_if<std::string>(&value);
    return name != nullptr ? std::optional(*name) : std::nullopt;
}

template <class Choice>
std::optional<Choice> read(const TomlValue& value, OneOf<Choice> /*words*/) {
    const auto* text = std::get_if<std::string>(&value);
    for (const auto& entry : Words<Choice>::all) {
        if (text != nullptr && entry.text == *text) {
            return entry.choice;
        }
    }
    return std::nullopt;
}

template <class Choice>
std::string hint(const TomlValue& value, OneOf<Choice> /*words*/) {
    std::vector<std::string> words;
    words.reserve(Words<Choice>::all.size());
    for (const auto& entry : Words<Choice>::all) {
        words.emplace_back(entry.text);
    }
    const auto* text = std::get_if<std::string>(&value);
    return text != nullptr ? suggestion(*text, words) : "";
}

template <class Allowed>
std::string hint(const TomlValue& /*value*/, const Allowed& /*allowed*/) {
    return "";
}

// Visits the fields and sets those that are given.
struct FieldReader {
    const SceneSettings& settings;
    std::vector<Problem>& problems;
    std::string section;                // "materials.NAME." where the visited keys lack it
    const Setting* material = nullptr;  // the beginning of a [materials.NAME], which must give every key

    template <class Member, class Allowed>
    void operator()(std::string_view name, Member& member, const Allowed& allowed) const {
        const std::string key = section + std::string(name);
        if (const Setting* given = settings.find(key)) {
            if (auto value = read(given->value, allowed)) {
                member = *std::move(value);
            } else {
                note(given->place, key, value_text(given->value),
                     allowed_text(allowed) + hint(given->value, allowed));
            }
        } else if (material != nullptr) {
            note(material->place, key, "nothing", allowed_text(allowed));
        }
    }
    void note(const Place& place, std::string key, std::string found, std::string allowed) const {
        problems.push_back({place.origin, place.line, std::move(key), std::move(found), std::move(allowed)});
    }
};

// The material of that name, where the keys tell a solid from a fluid.
std::optional<Material> read_material(const SceneSettings& settings, const std::string& name,
                                      std::vector<Problem>& problems) {
    const std::string key = "materials." + key_part(name);
    const Setting* section = settings.find(key);
    const FieldReader read_field{settings, problems, key + '.', section};
    const bool solid_keys =
        settings.find(key + ".youngs_modulus_pa") || settings.find(key + ".poissons_ratio");
    const bool fluid_keys = settings.find(key + ".sound_speed_m_per_s") != nullptr;
    if (solid_keys == fluid_keys) {
        read_field.note(section->place, key, solid_keys ? "keys of a solid and of a fluid" : "no material",
                        "youngs_modulus_pa, poissons_ratio and density_kg_per_m3 for a solid; "
                        "density_kg_per_m3 and sound_speed_m_per_s for a fluid");
        return std::nullopt;
    }
    // Keys that are missing or wrong keep harmless values, so that validate() does not complain of them
    // again.
    if (solid_keys) {
        Solid solid{1e9, 0.3, 1000};
        fields::visit_solid(solid, read_field);
        return solid;
    }
    Fluid fluid{1000, 1500};
    fields::visit_fluid(fluid, read_field);
    return fluid;
}

}  // namespace

std::string Problem::message() const {
    return origin + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
           (key.empty() ? "" : printable(key) + ": ") + "found " + found + ", allowed: " + allowed;
}

Problem SceneResult::placed(Fault fault) const {
    const auto said = places.find(fault.key);
    const auto& [where, line] = said != places.end() ? said->second : Place{origin, 0};
    return {where, line, std::move(fault.key), std::move(fault.found), std::move(fault.allowed)};
}

SceneResult parse_scene(std::string_view text, std::string_view origin,
                        std::span<const std::string> overrides) {
    SceneSettings settings(origin);
    settings.add_file(text);
    for (const std::string& option : overrides) {
        settings.add_option(option);
    }

    Scene scene;
    SceneResult result{std::nullopt, settings.problems(), std::string(origin), settings.places()};
    auto& problems = result.problems;
    fields::visit_scene(scene, FieldReader{settings, problems, ""});
    std::set<std::string> unclear_materials;
    for (const std::string& name : settings.materials()) {
        if (const auto material = read_material(settings, name, problems)) {
            scene.materials.emplace(name, *material);
        } else {
            unclear_materials.insert(quoted_briefly(name));
        }
    }
    if (settings.complete()) {  // else the options would be judged without what the file says beside them
        for (Fault& fault : validate(scene)) {
            // A key that names an unclear material is not at fault: that is reported where the material is
            // defined.
            if (!unclear_materials.contains(fault.found)) {
                problems.push_back(result.placed(std::move(fault)));
            }
        }
    }

    std::stable_sort(problems.begin(), problems.end(), [&](const Problem& a, const Problem& b) {
        return std::pair(a.origin != origin, a.line) < std::pair(b.origin != origin, b.line);
    });
    if (problems.empty()) {
        result.scene = std::move(scene);
    }
    return result;
}

}  // namespace hertzline
