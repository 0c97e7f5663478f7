#include "core/scene/scene_key.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <type_traits>
#include <utility>

#include "core/scene/scene_table.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"
#include "core/scene/units.hpp"

namespace hertzline {

namespace {

constexpr std::string_view materials = "materials.";

template <class T>
constexpr bool may_be_unset = false;
template <class T>
constexpr bool may_be_unset<std::optional<T>> = true;

template <class Member>
std::optional<SceneValue> value_in(const Member& member) {
    if constexpr (may_be_unset<Member>) {
        return member ? value_in(*member) : std::nullopt;
    } else if constexpr (std::is_enum_v<Member>) {
        const std::string_view text = word(member);
        return text.empty() ? SceneValue(static_cast<std::int64_t>(member)) : SceneValue(std::string(text));
    } else {
        return member;
    }
}

/// Sets the member, or takes its value back. @returns whether it may have that value
template <class Member>
bool assign(Member& member, const std::optional<SceneValue>& value) {
    if constexpr (may_be_unset<Member>) {
        typename Member::value_type given{};
        const bool taken = !value || assign(given, value);
        if (taken) {
            member = value ? Member(std::move(given)) : std::nullopt;
        }
        return taken;
    } else if constexpr (std::is_enum_v<Member>) {
        const auto* text = value ? std::get_if<std::string>(&*value) : nullptr;
        for (const auto& entry : Words<Member>::all) {
            if (text != nullptr && entry.text == *text) {
                member = entry.choice;
                return true;
            }
        }
        return false;
    } else {
        const auto* given = value ? std::get_if<Member>(&*value) : nullptr;
        if (given != nullptr) {
            member = *given;
        }
        return given != nullptr;
    }
}

/// Adds the facts that follow from the member's type.
template <class Member>
void describe(SceneKey& key, const Member& /*member*/) {
    if constexpr (may_be_unset<Member>) {
        key.is_optional = true;
        describe(key, typename Member::value_type{});
    } else if constexpr (std::is_enum_v<Member>) {
        key.kind = ValueKind::word;
        for (const auto& entry : Words<Member>::all) {
            key.words.emplace_back(entry.text);
        }
    } else {
        key.kind = static_cast<ValueKind>(SceneValue(Member{}).index());
        key.is_material = key.kind == ValueKind::word;
    }
}

/// Calls act(member) for the key's member of the scene, if it has it.
template <class AnyScene, class Act>
void at_member(AnyScene& scene, const SceneKey& key, const Act& act) {
    std::size_t number = 0;
    const auto chosen = [&](std::string_view, auto& member, const KeyRow& row) {
        if (number++ == key.row && row.key == key.key) {
            act(member);
        }
    };
    if (!key.owner) {
        table::visit_scene(scene, chosen);
    } else if (const auto own = scene.materials.find(*key.owner); own != scene.materials.end()) {
        table::visit_material(own->second, "", chosen);
    }
}

/// The keys that are visited. @param visit_all takes a function, and calls it for each of them
template <class VisitAll>
std::vector<SceneKey> keys_in(const VisitAll& visit_all) {
    std::vector<SceneKey> keys;
    visit_all([&](std::string_view section, const auto& member, const KeyRow& row) {
        SceneKey key{row};
        key.name = std::string(section) + '.' + std::string(row.key);
        key.row = keys.size();
        describe(key, member);
        keys.push_back(std::move(key));
    });
    return keys;
}

/// A number without a look at TOML's other ways to write one; nothing where those may matter.
template <class Number>
std::optional<SceneValue> plain_number(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = error == std::errc{} && end == text.data() + text.size();
    return whole ? std::optional<SceneValue>(number) : std::nullopt;
}

/// The names of many materials as a message shows them.
std::string listed(std::span<const std::string> names) {
    constexpr std::size_t max_listed = 16;
    return comma_separated(names.first(std::min(max_listed, names.size()))) +
           (names.size() > max_listed ? ", ..." : "");
}

std::optional<Fault> material_fault(const Scene& scene, const SceneKey& key, const std::string& name) {
    const MaterialSort sort = key.traits.sort;
    const Material* material = find_material(scene, name);
    if (material != nullptr && sort_of(*material) == sort) {
        return std::nullopt;
    }
    const std::vector<std::string> names = material_names(scene, sort);
    const auto* const other = sort == MaterialSort::solid ? ", a fluid" : ", a solid";
    return Fault{key.name, quoted_briefly(name) + (material == nullptr ? "" : other),
                 key.allowed() + ": " + listed(names) + suggestion(name, names)};
}

/// Returns the units of a number that was given with another one.
std::string unit_advice(const SceneKey& key, std::string_view text) {
    if (!has_unit(text)) {
        return "";
    }
    return key.range.unit.empty() ? ", without a unit" : " (" + units_like(key.range.unit) + ")";
}

bool is_inside(double value, const Range& range) {  // false also where the value is not a number
    return range.bounds == Bounds::closed ? value >= range.min && value <= range.max
                                          : value > range.min && value < range.max;
}

}  // namespace

std::string SceneKey::allowed() const {
    switch (kind) {
        case ValueKind::number: {
            const bool closed = range.bounds == Bounds::closed;
            return (closed ? "a number from " : "a number above ") + number_text(range.min) +
                   (closed ? " to " : " and below ") + number_text(range.max) +
                   (range.unit.empty() ? "" : " ") + std::string(range.unit);
        }
        case ValueKind::integer:
            return "an integer from " + number_text(static_cast<std::int64_t>(range.min)) + " to " +
                   number_text(static_cast<std::int64_t>(range.max));
        case ValueKind::word:
            break;
    }
    if (is_material) {
        return traits.sort == MaterialSort::solid ? "the name of a solid" : "the name of a fluid";
    }
    std::string text;
    for (const std::string& entry : words) {
        text += (text.empty() ? "one of " : ", ") + hertzline::quoted(entry);
    }
    return text;
}

std::optional<SceneValue> SceneKey::value(const Scene& scene) const {
    std::optional<SceneValue> value;
    at_member(scene, *this, [&](const auto& member) { value = value_in(member); });
    return value;
}

bool SceneKey::set(Scene& scene, const std::optional<SceneValue>& value) const {
    bool done = false;
    at_member(scene, *this, [&](auto& member) { done = assign(member, value); });
    return done;
}

bool SceneKey::has_effect(const Scene& scene) const {
    const auto keys = scene_keys();
    const auto needed = std::ranges::find(keys, traits.needs.key, &SceneKey::name);
    return needed == keys.end() || needed->value(scene) == SceneValue(std::string(traits.needs.word));
}

std::span<const SceneKey> scene_keys() {
    // never destroyed: a thread that is left behind at the end of the program may still use them
    static const auto& keys = *new const std::vector<SceneKey>(
        keys_in([scene = Scene{}](const auto& add) { table::visit_scene(scene, add); }));
    return keys;
}

std::vector<SceneKey> material_keys(const std::string& name, const Material& material) {
    const std::string section = std::string(materials) + key_part(name);
    std::vector<SceneKey> keys =
        keys_in([&](const auto& add) { table::visit_material(material, section, add); });
    for (SceneKey& key : keys) {
        key.owner = name;
    }
    return keys;
}

std::vector<SceneKey> keys_of(const Scene& scene) {
    const auto fixed = scene_keys();
    std::vector<SceneKey> keys(fixed.begin(), fixed.end());
    for (const auto& [name, material] : scene.materials) {
        std::ranges::move(material_keys(name, material), std::back_inserter(keys));
    }
    return keys;
}

tl::expected<SceneKey, Fault> scene_key_named(const Scene& scene, std::string_view name) {
    const std::string in_full = name.ends_with(".density") ? std::string(name) + "_kg_per_m3" : "";
    const auto find_in = [&](std::span<const SceneKey> keys) {
        const auto found = std::ranges::find_if(
            keys, [&](const SceneKey& key) { return key.name == name || key.name == in_full; });
        return found != keys.end() ? std::optional(*found) : std::nullopt;
    };
    auto key = find_in(scene_keys());
    for (const auto& [own, material] : scene.materials) {
        if (!key && name.starts_with(std::string(materials) + key_part(own) + '.')) {
            key = find_in(material_keys(own, material));
        }
    }
    if (key) {
        return *std::move(key);
    }
    std::vector<std::string> names;
    std::ranges::transform(keys_of(scene), std::back_inserter(names), &SceneKey::name);
    return tl::unexpected(
        Fault{"", quoted_briefly(name), "a key of the scene, as chain.preload_n" + suggestion(name, names)});
}

std::vector<std::string> words_of(const Scene& scene, const SceneKey& key) {
    if (!key.is_material) {
        return key.words;
    }
    std::vector<std::string> names = material_names(scene, key.traits.sort);
    std::ranges::sort(names);
    return names;
}

std::string_view word(ValueKind kind) noexcept {
    return std::array{"number", "integer", "word"}[static_cast<std::size_t>(kind)];
}

std::string value_text(const SceneValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) {
        return *text;
    }
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? number_text(*number) : number_text(std::get<std::int64_t>(value));
}

std::optional<SceneValue> value_as(ValueKind kind, const SceneValue& value) {
    const auto* integer = std::get_if<std::int64_t>(&value);
    if (kind == ValueKind::number && integer != nullptr) {
        return static_cast<double>(*integer);
    }
    return static_cast<std::size_t>(kind) == value.index() ? std::optional(value) : std::nullopt;
}

std::optional<SceneValue> read_value(ValueKind kind, std::string_view text) {
    const auto plain = kind == ValueKind::number    ? plain_number<double>(text)
                       : kind == ValueKind::integer ? plain_number<std::int64_t>(text)
                                                    : std::nullopt;
    if (plain) {
        return plain;
    }
    const auto found = toml_value(text);
    const auto* const given = found ? std::get_if<SceneValue>(&*found) : nullptr;
    return given != nullptr ? value_as(kind, *given) : std::nullopt;
}

tl::expected<SceneValue, Fault> read_text(const SceneKey& key, std::string_view text) {
    if (const auto value = read_value(key.kind, text)) {
        return *value;
    }
    if (const auto number = number_in_unit(text, key.range.unit)) {
        return SceneValue(*number);
    }
    const auto found = toml_value(text);
    if (!found && key.kind == ValueKind::word) {
        return SceneValue(std::string(text));  // "w.csv"
    }
    return tl::unexpected(Fault{key.name, found ? found_text(*found) : quoted_briefly(text),
                                key.allowed() + unit_advice(key, text)});
}

tl::expected<SceneValue, Fault> read_allowed(const Scene& scene, const SceneKey& key, std::string_view text) {
    auto value = read_text(key, text);
    if (value) {
        if (auto fault = value_fault(scene, key, *value)) {
            return tl::unexpected(*std::move(fault));
        }
    }
    return value;
}

tl::expected<SceneValue, Fault> allowed_value(const Scene& scene, const SceneKey& key, SceneValue value) {
    if (const auto* text = std::get_if<std::string>(&value); text != nullptr && key.kind != ValueKind::word) {
        return read_allowed(scene, key, *text);
    }
    if (key.kind == ValueKind::number && std::holds_alternative<std::int64_t>(value)) {
        value = static_cast<double>(std::get<std::int64_t>(value));
    }
    if (static_cast<std::size_t>(key.kind) != value.index()) {
        return tl::unexpected(Fault{key.name, toml_text(value), key.allowed()});
    }
    if (auto fault = value_fault(scene, key, value)) {
        return tl::unexpected(*std::move(fault));
    }
    return value;
}

std::optional<Fault> value_fault(const Scene& scene, const SceneKey& key, const SceneValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) {
        if (key.is_material) {
            return material_fault(scene, key, *text);
        }
        return std::ranges::find(key.words, *text) != key.words.end()
                   ? std::nullopt
                   : std::optional(Fault{key.name, quoted_briefly(*text),
                                         key.allowed() + suggestion(*text, key.words)});
    }
    const auto* number = std::get_if<double>(&value);
    const double size = number != nullptr ? *number : static_cast<double>(std::get<std::int64_t>(value));
    return key.kind != ValueKind::word && is_inside(size, key.range)
               ? std::nullopt
               : std::optional(Fault{key.name, value_text(value), key.allowed()});
}

}  // namespace hertzline
