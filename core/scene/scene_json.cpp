#include "core/scene/scene_json.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/scene/text.hpp"
#include "core/scene/units.hpp"

namespace hertzline {

namespace {

/// The value as text, for a message.
std::string found_json(const Json& value) {
    constexpr std::size_t longest = 60;
    return value.is_string() ? quoted_briefly(value.get_ref<const std::string&>())
                             : printable(json_text(value), longest);
}

/// The number as one of that kind; nothing when it is of another kind.
std::optional<SceneValue> number_in(const Json& json, ValueKind kind) {
    constexpr double whole_below = 9e15;
    if (kind == ValueKind::word || !json.is_number()) {
        return std::nullopt;
    }
    const auto number = json.get<double>();
    if (kind == ValueKind::number) {
        return number;
    }
    if (number != std::floor(number) || std::abs(number) > whole_below) {
        return std::nullopt;
    }
    return static_cast<std::int64_t>(number);
}

/// The value as one of the key, or its fault.
tl::expected<SceneValue, Fault> value_in(const Json& json, const SceneKey& key) {
    if (const auto* text = json.get_ptr<const std::string*>()) {
        if (key.kind == ValueKind::word && !key.is_list()) {
            return SceneValue(*text);
        }
        if (key.is_list() || has_unit(*text)) {
            return read_text(key, *text);
        }
    }
    if (key.is_list()) {
        return json.is_array()
                   ? read_list(key, json.size(),
                               [&](const SceneKey& entry, std::size_t i) { return value_in(json[i], entry); })
                   : tl::unexpected(Fault{key.name, found_json(json), key.allowed()});
    }
    if (const auto number = number_in(json, key.kind)) {
        return *number;
    }
    return tl::unexpected(Fault{key.name, found_json(json), key.allowed()});
}

/// The key of that name, or the fault of one that is unknown.
tl::expected<SceneKey, Fault> known_key(const Scene& scene, const std::string& name) {
    return scene_key_named(scene, name).map_error([&](Fault fault) {
        if (fault.key.empty()) {  // else it is known, and has no such entry
            fault.key = quoted_briefly(name);
            fault.found = "an unknown key";
            if (name.starts_with("materials.")) {
                fault.found = "a material that the scene does not have";
                fault.allowed = "keys of its own materials: they come from its file";
            }
        }
        return fault;
    });
}

/// Adds the values in the object and the objects in it, each by its key: "drive.cycles". No key has an empty object.
void add_values(const Json& object, const std::string& section, Json& values) {
    for (const auto& [name, value] : object.items()) {
        const std::string key = section.empty() ? name : section + '.' + key_part(name);
        if (value.is_object() && (section.empty() || !value.empty())) {
            add_values(value, key, values);
        } else {
            values[key] = value;
        }
    }
}

/// Sets one key. @returns its fault
std::optional<Fault> set_key(Scene& scene, const std::string& name, const Json& json) {
    const auto key = known_key(scene, name);
    if (!key) {
        return key.error();
    }
    if (json.is_null()) {
        return key->set(scene, std::nullopt)
                   ? std::nullopt
                   : std::optional(Fault{name, "null", key->allowed() + ", always"});
    }
    const auto value = value_in(json, *key);
    if (!value) {
        return value.error();
    }
    if (auto fault = value_fault(scene, *key, *value)) {
        return fault;
    }
    key->set(scene, *value);
    return std::nullopt;
}

Json number_json(const SceneKey& key, double number) {
    return key.kind == ValueKind::integer ? Json(static_cast<std::int64_t>(number)) : Json(number);
}

Json described(const Scene& scene, const SceneKey& key) {
    Json entry{{"value", json_of(key.value(scene))}};
    if (!key.range.unit.empty()) {
        entry["unit"] = key.range.unit;
    }
    if (key.kind != ValueKind::word) {
        entry["minimum"] = number_json(key, key.range.min);
        entry["maximum"] = number_json(key, key.range.max);
    }
    entry["kind"] = key.is_list() ? "list" : word(key.kind);
    if (key.kind == ValueKind::word) {
        entry["words"] = words_of(scene, key);
    }
    entry["description"] = key.allowed();
    return entry;
}

/// The schema of a value without its documentation: that of its entries within that of a list.
Json type_schema(const SceneKey& key) {
    const std::string_view type = key.is_list()                 ? "array"
                                  : key.kind == ValueKind::word ? "string"
                                                                : word(key.kind);
    Json schema{{"type", key.is_optional ? Json{type, "null"} : Json(type)}};
    if (key.is_list()) {
        schema["minItems"] = key.counts.front().least;
        schema["maxItems"] = key.counts.front().most;
        schema["items"] = type_schema(key.entry(0));
        return schema;
    }
    if (key.kind != ValueKind::word) {
        const bool closed = key.range.bounds == Bounds::closed;
        schema[closed ? "minimum" : "exclusiveMinimum"] = number_json(key, key.range.min);
        schema[closed ? "maximum" : "exclusiveMaximum"] = number_json(key, key.range.max);
    }
    if (!key.words.empty()) {
        schema["enum"] = key.words;
        if (key.is_optional) {
            schema["enum"].push_back(nullptr);
        }
    }
    return schema;
}

Json key_schema(const SceneKey& key) {
    Json schema = type_schema(key);
    schema["description"] = key.doc;
    if (!key.range.unit.empty()) {
        schema["unit"] = key.range.unit;
    }
    if (!key.owner) {
        schema["default"] = json_of(key.value(Scene{}));
    }
    if (!key.traits.needs.key.empty()) {
        const Need& needs = key.traits.needs;
        Json words = Json::array();
        std::ranges::copy_if(needs.words, std::back_inserter(words), [](auto word) { return !word.empty(); });
        schema["needs"][std::string(needs.key)] = words.size() == 1 ? words[0] : words;
    }
    const auto keys = scene_keys();
    if (const auto list =
            std::ranges::find(keys, key.name, [](const SceneKey& other) { return other.traits.each; });
        list != keys.end()) {
        schema["replaced_by"] = list->name;
    }
    return schema;
}

Json closed_object() {
    return {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
}

/// Adds a key to the schema of its section.
void add_key(Json& section, const SceneKey& key) {
    section["properties"][std::string(key.key)] = key_schema(key);
    if (!key.is_list() && (!key.owner || !key.is_optional)) {
        section["required"].push_back(key.key);
    }
}

Json material_schema(const Material& material) {
    Json schema = closed_object();
    for (const SceneKey& key : material_keys("NAME", material)) {
        add_key(schema, key);
    }
    return schema;
}

}  // namespace

Json json_of(const std::optional<SceneValue>& value) {
    return value ? std::visit([](const auto& held) { return Json(held); }, *value) : Json(nullptr);
}

Json scene_json(const Scene& scene) {
    Json json = Json::object();
    for (const SceneKey& key : scene_keys()) {
        if (const auto value = key.value(scene); value || !key.is_list()) {
            json[key.section()][std::string(key.key)] = json_of(value);
        }
    }
    for (const auto& [name, material] : scene.materials) {
        Json& own = json["materials"][name] = Json::object();
        for (const SceneKey& key : material_keys(name, material)) {
            if (const auto value = key.value(scene)) {
                own[std::string(key.key)] = json_of(value);
            }
        }
    }
    return json;
}

tl::expected<Scene, std::vector<Fault>> scene_of_json(const Json& json) {
    if (!json.is_object()) {
        return tl::unexpected(std::vector{Fault{"scene", found_json(json), "an object of sections"}});
    }
    Scene scene;
    const Json materials = json.value("materials", Json::object());
    for (const auto& [name, keys] : materials.items()) {
        const bool solid = keys.is_object() && keys.contains("youngs_modulus_pa");
        scene.materials[name] = solid ? Material(Solid{}) : Material(Fluid{});
    }
    Json values = Json::object();
    add_values(json, "", values);
    return with_values(std::move(scene), values);
}

tl::expected<Scene, std::vector<Fault>> with_values(Scene scene, const Json& values) {
    std::vector<Fault> faults;
    for (const auto& [name, value] : values.items()) {
        if (name.ends_with(".density") && values.contains(name + "_kg_per_m3")) {
            faults.push_back({name, found_json(value), "density or density_kg_per_m3, not both"});
        } else if (auto fault = set_key(scene, name, value)) {
            faults.push_back(*std::move(fault));
        }
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    return scene;
}

Json values_of_keys(const Scene& scene, const Json& values) {
    Json found = Json::object();
    for (const auto& entry : values.items()) {
        // in place of an entry its list: a scene that gives none has no entry
        const std::string name(without_entry(entry.key()));
        const auto key = scene_key_named(scene, name);
        found[name] = json_of(key ? key->value(scene) : std::nullopt);
    }
    return found;
}

tl::expected<Json, std::vector<Fault>> described_values(const Scene& scene,
                                                        const std::vector<std::string>& keys) {
    Json all = Json::object();
    std::vector<Fault> faults;
    if (keys.empty()) {
        for (const SceneKey& key : keys_of(scene)) {
            all[key.name] = described(scene, key);
        }
    }
    for (const std::string& name : keys) {
        if (const auto key = known_key(scene, name)) {
            all[name] = described(scene, *key);
        } else {
            faults.push_back(key.error());
        }
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    return all;
}

Json material_json(const BuiltInMaterial& material) {
    const auto* solid = std::get_if<Solid>(&material.material);
    const double density =
        std::visit([](const auto& sort) { return sort.density_kg_per_m3; }, material.material);
    const auto of_solid = [&](auto member) -> Json {
        if (solid == nullptr) {
            return nullptr;
        }
        const std::optional<double> value = solid->*member;
        return value ? Json(*value) : Json(nullptr);
    };
    Json json;
    json["name"] = material.name;
    json["sort"] = solid != nullptr ? "solid" : "fluid";
    json["youngs_modulus_pa"] = of_solid(&Solid::youngs_modulus_pa);
    json["poissons_ratio"] = of_solid(&Solid::poissons_ratio);
    json["density_kg_per_m3"] = density;
    json["sound_speed_m_per_s"] = acoustic_impedance(material.material) / density;
    json["impedance_pa_s_per_m"] = acoustic_impedance(material.material);
    json["yield_strength_pa"] = of_solid(&Solid::yield_strength_pa);
    json["flexural_strength_pa"] = of_solid(&Solid::flexural_strength_pa);
    json["source"] = material.source;
    return json;
}

Json scene_schema() {
    Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                {"title", "A scene of hertzline with every default"}};
    schema.update(closed_object());
    Json& sections = schema["properties"];
    for (const SceneKey& key : scene_keys()) {
        if (!sections.contains(key.section())) {
            sections[key.section()] = closed_object();
            schema["required"].push_back(key.section());
        }
        add_key(schema["properties"][key.section()], key);
    }
    sections["materials"] = {
        {"type", "object"},
        {"additionalProperties", {{"anyOf", {material_schema(Solid{}), material_schema(Fluid{})}}}}};
    return schema;
}

}  // namespace hertzline
