#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "core/scene/scene_key.hpp"
#include "core/scene/scene_settings.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline {

namespace {

/// Sets the key as the settings say. validate() checks its bounds.
/// @param section the beginning of a [materials.NAME], which gives every key but the optional ones; nullptr: none
void read_key(const SceneSettings& settings, const SceneKey& key, const Setting* section, Scene& scene,
              std::vector<Fault>& faults) {
    const Setting* given = settings.find(key.name);
    if (given == nullptr) {
        if (section != nullptr && !key.is_optional) {
            faults.push_back({key.name, "nothing", key.allowed(), section->place});
        }
        return;
    }
    const auto value = value_of(key, given->value);
    if (!value) {
        faults.push_back(value.error());
        faults.back().place = given->place;
    } else if (!key.set(scene, *value)) {
        faults.push_back({key.name, found_text(given->value),
                          key.allowed() + suggestion(value_text(*value), key.words), given->place});
    }
}

/// Sets the entries of lists that options give.
void read_entries(const SceneSettings& settings, Scene& scene, std::vector<Fault>& faults) {
    for (const std::string& name : settings.entries()) {
        if (const auto key = scene_key_named(scene, name)) {
            read_key(settings, *key, nullptr, scene, faults);
        } else {
            faults.push_back(key.error());
            faults.back().place = settings.find(name)->place;
        }
    }
}

/// The keys that a material of one sort has and one of the other lacks, each with its end after "materials.NAME.".
bool gives_key_of(const SceneSettings& settings, const std::string& name, const Material& material,
                  const Material& other) {
    const auto others = material_keys(name, other);
    return std::ranges::any_of(material_keys(name, material), [&](const SceneKey& key) {
        return settings.find(key.name) != nullptr &&
               std::ranges::find(others, key.name, &SceneKey::name) == others.end();
    });
}

/// Adds the material of that name, where the keys tell a solid from a fluid. @returns whether they do
bool read_material(const SceneSettings& settings, const std::string& name, Scene& scene,
                   std::vector<Fault>& faults) {
    // Keys that are missing or wrong keep harmless values: validate() need not complain of them again.
    const Material solid = Solid{1e9, 0.3, 1000};
    const Material fluid = Fluid{1000, 1500};
    const std::string section = "materials." + key_part(name);
    const Setting* beginning = settings.find(section);
    const bool solid_keys = gives_key_of(settings, name, solid, fluid);
    const bool fluid_keys = gives_key_of(settings, name, fluid, solid);
    if (solid_keys == fluid_keys) {
        faults.push_back({section, solid_keys ? "keys of a solid and of a fluid" : "no material",
                          "youngs_modulus_pa, poissons_ratio and density_kg_per_m3 for a solid; "
                          "density_kg_per_m3 and sound_speed_m_per_s for a fluid",
                          beginning->place});
        return false;
    }
    const Material& material = scene.materials.emplace(name, solid_keys ? solid : fluid).first->second;
    for (const SceneKey& key : material_keys(name, material)) {
        read_key(settings, key, beginning, scene, faults);
    }
    return true;
}

// Reads every [materials.NAME]. Returns the quoted names of those that are neither solid nor fluid.
std::set<std::string> read_materials(const SceneSettings& settings, Scene& scene,
                                     std::vector<Fault>& faults) {
    std::set<std::string> unclear;
    for (const std::string& name : settings.materials()) {
        if (!read_material(settings, name, scene, faults)) {
            unclear.insert(quoted_briefly(name));
        }
    }
    return unclear;
}

/// Whether a hash does without that value of the key.
bool changes_nothing(const Scene& scene, const SceneKey& key, const SceneValue& value,
                     const Scene& defaults) {
    return (key.traits.hashed == Hashed::when_changed && value == key.value(defaults)) ||
           (key.traits.hashed == Hashed::when_in_effect && !key.has_effect(scene));
}

/// A section's heading comes before its first key. @param defaults keys that change nothing beside these values are left out; nullptr:
/// every key is written
std::string text_of(const Scene& scene, const Scene* defaults) {
    std::string text;
    std::string section;
    const auto add = [&](std::span<const SceneKey> keys) {
        for (const SceneKey& key : keys) {
            const auto value = key.value(scene);
            if (!value || (defaults != nullptr && changes_nothing(scene, key, *value, *defaults))) {
                continue;
            }
            if (key.section() != section) {
                section = key.section();
                text += (text.empty() ? "[" : "\n[") + section + "]\n";
            }
            text += std::string(key.key) + " = " + toml_text(*value) + '\n';
        }
    };
    add(scene_keys());
    for (const auto& [name, material] : scene.materials) {
        add(material_keys(name, material));
    }
    return text;
}

}  // namespace

Fault ParsedScene::placed(Fault fault) const {
    auto given = places.find(fault.key);
    if (given == places.end()) {  // an entry of a list that was given as a whole
        given = places.find(std::string(without_entry(fault.key)));
    }
    fault.place = given != places.end() ? given->second : Place{origin, 0};
    return fault;
}

tl::expected<ParsedScene, std::vector<Fault>> parse_scene(std::string_view text, std::string_view origin,
                                                          std::span<const std::string> overrides) {
    std::vector<Fault> faults;
    SceneSettings settings(origin, faults);
    const bool readable = settings.add_file(text);
    for (const std::string& option : overrides) {
        settings.add_option(option);
    }

    ParsedScene parsed{{}, std::string(origin), settings.places()};
    for (const SceneKey& key : scene_keys()) {
        read_key(settings, key, nullptr, parsed.scene, faults);
    }
    const std::set<std::string> unclear_materials = read_materials(settings, parsed.scene, faults);
    read_entries(settings, parsed.scene, faults);
    if (readable) {  // else the options would be judged without the keys of the file
        for (Fault& fault : validate(parsed.scene)) {
            // A key that names an unclear material is not at fault: that is reported where the material is defined.
            if (!unclear_materials.contains(fault.found)) {
                faults.push_back(parsed.placed(std::move(fault)));
            }
        }
    }
    if (faults.empty()) {
        return parsed;
    }
    std::stable_sort(faults.begin(), faults.end(), [&](const Fault& a, const Fault& b) {
        return std::pair(a.place.origin != origin, a.place.line) <
               std::pair(b.place.origin != origin, b.place.line);
    });
    return tl::unexpected(std::move(faults));
}

std::string to_toml(const Scene& scene) {
    return text_of(scene, nullptr);
}

std::string scene_hash(const Scene& scene) {
    static const auto& defaults = *new const Scene();  // never destroyed, as scene_keys()
    return hash_text(text_of(scene, &defaults));
}

}  // namespace hertzline
