#include "core/scene/scene_key.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <type_traits>
#include <vector>

#include "core/scene/scene_fields.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"

namespace hertzline {

namespace {

using fields::Count;
using fields::Key;
using fields::MaterialSort;
using fields::OneOf;
using fields::Range;

constexpr std::string_view materials = "materials.";

bool is_called(const Key& key, std::string_view name) {
    const std::size_t section = key.section.size();
    return name.size() == section + 1 + key.name.size() && name.starts_with(key.section) &&
           name[section] == '.' && name.ends_with(key.name);
}

/// Calls visit(member, allowed) for the key of that name, if there is one.
template <class AnyScene, class Visit>
void visit_key(AnyScene& scene, std::string_view name, Visit&& visit) {
    const auto chosen = [&](const Key& key, auto& member, const auto& allowed) {
        if (is_called(key, name)) {
            visit(key, member, allowed);
        }
    };
    if (!name.starts_with(materials)) {
        fields::visit_scene(scene, chosen);
        return;
    }
    const std::size_t dot = name.rfind('.');
    const auto found =
        dot <= materials.size()
            ? scene.materials.end()
            : scene.materials.find(std::string(name.substr(materials.size(), dot - materials.size())));
    if (found == scene.materials.end()) {
        return;
    }
    const std::string_view section = name.substr(0, dot);
    if (auto* solid = std::get_if<Solid>(&found->second)) {
        fields::visit_solid(*solid, section, chosen);
    } else {
        fields::visit_fluid(std::get<Fluid>(found->second), section, chosen);
    }
}

// What a key takes, by the type of what it allows.
ValueKind kind_of(const Range& /*range*/) {
    return ValueKind::number;
}
ValueKind kind_of(const Count& /*count*/) {
    return ValueKind::integer;
}
template <class Words>
ValueKind kind_of(const Words& /*words*/) {
    return ValueKind::word;
}

std::string unit_of(const Range& range) {
    return std::string(range.unit);
}
template <class Other>
std::string unit_of(const Other& /*other*/) {
    return "";
}

/// @returns whether there is such a value
template <class Member>
bool assign(Member& member, const SceneValue& value, const Range& /*range*/) {
    member = std::get<double>(value);
    return true;
}
template <class Member>
bool assign(Member& member, const SceneValue& value, const Count& /*count*/) {
    member = std::get<std::int64_t>(value);
    return true;
}
template <class Member>
bool assign(Member& member, const SceneValue& value, MaterialSort /*sort*/) {
    member = std::get<std::string>(value);
    return true;
}
template <class Member, class Choice>
bool assign(Member& member, const SceneValue& value, OneOf<Choice> /*words*/) {
    for (const auto& entry : Words<Choice>::all) {
        if (entry.text == std::get<std::string>(value)) {
            member = entry.choice;
            return true;
        }
    }
    return false;
}

template <class Choice>
std::vector<std::string> words_of(OneOf<Choice> /*words*/) {
    std::vector<std::string> words;
    words.reserve(Words<Choice>::all.size());
    for (const auto& entry : Words<Choice>::all) {
        words.emplace_back(entry.text);
    }
    return words;
}
template <class Other>
std::vector<std::string> words_of(const Other& /*other*/) {
    return {};
}

// The value of a member.
SceneValue present(const Scene& /*scene*/, double member) {
    return member;
}
SceneValue present(const Scene& /*scene*/, std::int64_t member) {
    return member;
}
SceneValue present(const Scene& /*scene*/, const std::string& member) {
    return member;
}
template <class Choice>
requires std::is_enum_v<Choice> SceneValue present(const Scene& /*scene*/, Choice member) {
    return std::string(word(member));
}
template <class Member>
std::optional<SceneValue> value_in(const Scene& scene, const std::optional<Member>& member) {
    return member ? std::optional(present(scene, *member)) : std::nullopt;
}
template <class Member>
std::optional<SceneValue> value_in(const Scene& scene, const Member& member) {
    return present(scene, member);
}

template <class Member>
bool take_back(std::optional<Member>& member) {
    member.reset();
    return true;
}
template <class Member>
bool take_back(Member& /*member*/) {
    return false;
}

// Bounds and words, as who draws a knob needs them.
void add_bounds(const Scene& /*scene*/, const Range& range, SceneKeyInfo& info) {
    info.minimum = range.min;
    info.maximum = range.max;
}
void add_bounds(const Scene& /*scene*/, const Count& count, SceneKeyInfo& info) {
    info.minimum = static_cast<double>(count.min);
    info.maximum = static_cast<double>(count.max);
}
void add_bounds(const Scene& scene, MaterialSort sort, SceneKeyInfo& info) {
    const auto is_of = [sort](const Material& material) {
        return std::holds_alternative<Solid>(material) == (sort == MaterialSort::solid);
    };
    std::set<std::string> names;
    for (const BuiltInMaterial& entry : built_in_materials()) {
        if (is_of(entry.material)) {
            names.emplace(entry.name);
        }
    }
    for (const auto& [name, material] : scene.materials) {
        if (is_of(material)) {
            names.insert(name);
        }
    }
    info.words.assign(names.begin(), names.end());
}
template <class Choice>
void add_bounds(const Scene& /*scene*/, OneOf<Choice> words, SceneKeyInfo& info) {
    info.words = words_of(words);
}

}  // namespace

std::vector<std::string> scene_key_names(const Scene& scene) {
    std::vector<std::string> keys;
    for (const SceneKey& key : scene_keys()) {
        keys.push_back(key.key);
    }
    for (const auto& [name, material] : scene.materials) {
        const std::string section = std::string(materials) + name;
        const auto add = [&](const Key& key, const auto&, const auto&) { keys.push_back(key.text()); };
        if (const auto* solid = std::get_if<Solid>(&material)) {
            fields::visit_solid(*solid, section, add);
        } else {
            fields::visit_fluid(std::get<Fluid>(material), section, add);
        }
    }
    return keys;
}

namespace {

/// A number without a look at TOML's other ways to write one; nothing where those may matter.
template <class Number>
std::optional<Number> plain_number(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = error == std::errc{} && end == text.data() + text.size();
    return whole ? std::optional(number) : std::nullopt;
}

}  // namespace

std::string value_text(const SceneValue& value) {
    if (const auto* word = std::get_if<std::string>(&value)) {
        return *word;
    }
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? number_text(*number) : number_text(std::get<std::int64_t>(value));
}

tl::expected<SceneKeyInfo, Fault> scene_key_named(const Scene& scene, std::string_view name) {
    std::optional<SceneKeyInfo> found;
    visit_key(scene, name, [&](const Key& key, const auto&, const auto& allowed) {
        found = SceneKeyInfo{key.text(), kind_of(allowed), unit_of(allowed), allowed_text(allowed)};
        add_bounds(scene, allowed, *found);
    });
    if (found) {
        return *std::move(found);
    }
    return tl::unexpected(
        Fault{"", quoted_briefly(name),
              "a key of the scene, as chain.preload_n" + suggestion(name, scene_key_names(scene))});
}

tl::expected<SceneValue, Fault> read_value(const SceneKeyInfo& key, std::string_view text) {
    if (key.kind == ValueKind::number) {
        if (const auto number = plain_number<double>(text)) {
            return *number;
        }
    } else if (key.kind == ValueKind::integer) {
        if (const auto number = plain_number<std::int64_t>(text)) {
            return *number;
        }
    }
    const auto value = toml_value(text);
    if (!value) {
        return tl::unexpected(Fault{key.name, value.error().found, key.allowed});
    }
    const auto* integer = std::get_if<std::int64_t>(&*value);
    if (integer != nullptr && key.kind == ValueKind::number) {
        return static_cast<double>(*integer);
    }
    if (integer != nullptr && key.kind == ValueKind::integer) {
        return *integer;
    }
    if (const auto* number = std::get_if<double>(&*value);
        number != nullptr && key.kind == ValueKind::number) {
        return *number;
    }
    if (const auto* word = std::get_if<std::string>(&*value);
        word != nullptr && key.kind == ValueKind::word) {
        return *word;
    }
    return tl::unexpected(Fault{key.name, hertzline::value_text(*value), key.allowed});
}

std::optional<Fault> value_fault(const Scene& scene, const SceneKeyInfo& key, const SceneValue& value) {
    Scene changed = scene;
    std::optional<Fault> fault;
    visit_key(changed, key.name, [&](const Key&, auto& member, const auto& allowed) {
        if (!assign(member, value, allowed)) {
            const std::string text = value_text(value);
            fault = Fault{key.name, quoted_briefly(text), key.allowed + suggestion(text, words_of(allowed))};
        }
    });
    if (fault) {
        return fault;
    }
    // what is wrong with a value by itself is said in the words of its bounds
    for (Fault& of_scene : validate(changed)) {
        if (of_scene.key == key.name && of_scene.allowed.starts_with(key.allowed)) {
            return std::move(of_scene);
        }
    }
    return std::nullopt;
}

std::optional<SceneValue> value_of(const Scene& scene, std::string_view key) {
    std::optional<SceneValue> value;
    visit_key(scene, key,
              [&](const Key&, const auto& member, const auto&) { value = value_in(scene, member); });
    return value;
}

bool unset_value(Scene& scene, std::string_view key) {
    bool done = false;
    visit_key(scene, key, [&](const Key&, auto& member, const auto&) { done = take_back(member); });
    return done;
}

void set_value(Scene& scene, std::string_view key, const SceneValue& value) {
    visit_key(scene, key,
              [&](const Key&, auto& member, const auto& allowed) { assign(member, value, allowed); });
}

}  // namespace hertzline
