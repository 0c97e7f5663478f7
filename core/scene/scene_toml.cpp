#include "core/scene/scene_toml.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "core/scene/scene_fields.hpp"
#include "core/scene/scene_settings.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

using fields::Count;
using fields::Key;
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

template <class Member>
constexpr bool is_optional = false;
template <class Value>
constexpr bool is_optional<std::optional<Value>> = true;

// Visits the fields and sets those that are given.
struct FieldReader {
    const SceneSettings& settings;
    std::vector<Fault>& faults;
    const Setting* material =
        nullptr;  // the beginning of a [materials.NAME], which must give every key but the optional ones

    template <class Member, class Allowed>
    void operator()(const Key& key, Member& member, const Allowed& allowed) const {
        const std::string text = key.text();
        if (const Setting* given = settings.find(text)) {
            if (auto value = read(given->value, allowed)) {
                member = *std::move(value);
            } else {
                faults.push_back({text, value_text(given->value),
                                  allowed_text(allowed) + hint(given->value, allowed), given->place});
            }
        } else if (material != nullptr && !is_optional<Member>) {
            faults.push_back({text, "nothing", allowed_text(allowed), material->place});
        }
    }
};

// The material of that name, where the keys tell a solid from a fluid.
std::optional<Material> read_material(const SceneSettings& settings, const std::string& name,
                                      std::vector<Fault>& faults) {
    const std::string section = "materials." + key_part(name);
    const Setting* beginning = settings.find(section);
    const auto given = [&](const char* key) { return settings.find(section + '.' + key) != nullptr; };
    const bool solid_keys = given("youngs_modulus_pa") || given("poissons_ratio") ||
                            given("yield_strength_pa") || given("flexural_strength_pa");
    const bool fluid_keys = given("sound_speed_m_per_s");
    if (solid_keys == fluid_keys) {
        faults.push_back({section, solid_keys ? "keys of a solid and of a fluid" : "no material",
                          "youngs_modulus_pa, poissons_ratio and density_kg_per_m3 for a solid; "
                          "density_kg_per_m3 and sound_speed_m_per_s for a fluid",
                          beginning->place});
        return std::nullopt;
    }
    // Keys that are missing or wrong keep harmless values: validate() need not complain of them again.
    const FieldReader read_field{settings, faults, beginning};
    if (solid_keys) {
        Solid solid{1e9, 0.3, 1000};
        fields::visit_solid(solid, section, read_field);
        return solid;
    }
    Fluid fluid{1000, 1500};
    fields::visit_fluid(fluid, section, read_field);
    return fluid;
}

// Reads every [materials.NAME]. Returns the quoted names of those that are neither solid nor fluid.
std::set<std::string> read_materials(const SceneSettings& settings, Scene& scene,
                                     std::vector<Fault>& faults) {
    std::set<std::string> unclear;
    for (const std::string& name : settings.materials()) {
        if (const auto material = read_material(settings, name, faults)) {
            scene.materials.emplace(name, *material);
        } else {
            unclear.insert(quoted_briefly(name));
        }
    }
    return unclear;
}

}  // namespace

Fault ParsedScene::placed(Fault fault) const {
    const auto given = places.find(fault.key);
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
    fields::visit_scene(parsed.scene, FieldReader{settings, faults});
    const std::set<std::string> unclear_materials = read_materials(settings, parsed.scene, faults);
    if (readable) {  // else the options would be judged without what the file says beside them
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

}  // namespace hertzline
