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

template <class T>
constexpr bool has_entries = false;
template <class T>
constexpr bool has_entries<std::vector<T>> = true;
template <class T, std::size_t N>
constexpr bool has_entries<std::array<T, N>> = true;

/// The places of an entry in its lists; none: the whole value.
using EntryPath = std::span<const std::size_t>;

/// A list without entries is not given.
template <class Member>
std::optional<SceneValue> value_in(const Member& member, EntryPath path) {
    if constexpr (may_be_unset<Member>) {
        return member ? value_in(*member, path) : std::nullopt;
    } else if constexpr (has_entries<Member>) {
        if (!path.empty()) {
            return path[0] < member.size() ? value_in(member[path[0]], path.subspan(1)) : std::nullopt;
        }
        if constexpr (std::is_constructible_v<SceneValue, Member>) {
            return member.empty() ? std::nullopt : std::optional<SceneValue>(member);
        } else {
            return std::vector<double>(member.begin(), member.end());
        }
    } else if constexpr (std::is_enum_v<Member>) {
        const std::string_view text = word(member);
        return text.empty() ? SceneValue(static_cast<std::int64_t>(member)) : SceneValue(std::string(text));
    } else {
        return member;
    }
}

/// Sets the member or an entry of it, or takes its value back. @returns whether it may have that value
template <class Member>
bool assign(Member& member, EntryPath path, const std::optional<SceneValue>& value) {
    if constexpr (may_be_unset<Member>) {
        typename Member::value_type given{};
        const bool taken = !value || assign(given, path, value);
        if (taken) {
            member = value ? Member(std::move(given)) : std::nullopt;
        }
        return taken;
    } else if constexpr (has_entries<Member>) {
        if (!path.empty()) {
            return path[0] < member.size() && assign(member[path[0]], path.subspan(1), value);
        }
        if constexpr (std::is_constructible_v<SceneValue, Member>) {
            const auto* given = value ? std::get_if<Member>(&*value) : nullptr;
            if (given != nullptr || !value) {
                member = given != nullptr ? *given : Member{};
            }
            return given != nullptr || !value;
        } else {
            const auto* given = value ? std::get_if<std::vector<double>>(&*value) : nullptr;
            const bool fits = given != nullptr && given->size() == member.size();
            if (fits) {
                std::ranges::copy(*given, member.begin());
            }
            return fits;
        }
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
    } else if constexpr (has_entries<Member>) {
        constexpr bool is_list = std::is_constructible_v<SceneValue, Member>;
        key.is_optional = is_list;
        key.counts.push_back(is_list ? EntryCount{1, key.traits.most_entries}
                                     : EntryCount{Member{}.size(), Member{}.size()});
        const bool is_optional = key.is_optional;
        describe(key, typename Member::value_type{});
        key.is_optional = is_optional;
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

/// The whole number from 1 on that an entry's name has in its brackets; 0: none.
std::size_t entry_number(std::string_view text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = error == std::errc{} && end == text.data() + text.size();
    return whole && text.front() != '0' ? number : 0;
}

/// The entry of the key. @param entry "[2]", or "[2][3]" of a list of points
tl::expected<SceneKey, Fault> entry_named(const Scene& scene, SceneKey key, std::string_view entry) {
    while (!entry.empty()) {
        const std::size_t end = entry.find(']');
        const std::string name = key.name + std::string(entry.substr(0, std::min(end, entry.size()) + 1));
        const std::size_t number = end == std::string_view::npos || entry.front() != '['
                                       ? 0
                                       : entry_number(entry.substr(1, end - 1));
        if (!key.is_list()) {
            return tl::unexpected(Fault{printable(name), "an entry of a single value", key.name});
        }
        const auto value = key.value(scene);
        const std::size_t count = value ? entries_of(*value) : 0;
        if (number == 0 || number > count) {
            const std::string last = number_text(static_cast<std::int64_t>(count));
            return tl::unexpected(Fault{
                printable(name),
                number > 0 ? "entry " + number_text(static_cast<std::int64_t>(number)) : "no entry",
                count == 0 ? "none: the scene does not give " + key.name
                           : key.name + "[1]" + (count > 1 ? " to " + key.name + "[" + last + "]" : "")});
        }
        key = key.entry(number - 1);
        entry.remove_prefix(end + 1);
    }
    return key;
}

/// The parts between the commas of a text in brackets that are in no further ones; nothing where it has no such form.
std::optional<std::vector<std::string_view>> parts_of_list(std::string_view text) {
    text = trimmed(text, " \t");
    if (text.size() < 2 || text.front() != '[' || text.back() != ']') {
        return std::nullopt;
    }
    text = text.substr(1, text.size() - 2);
    std::vector<std::string_view> parts;
    int open = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        open += text[i] == '[' ? 1 : text[i] == ']' ? -1 : 0;
        if (open < 0) {
            return std::nullopt;
        }
        if (text[i] == ',' && open == 0) {
            parts.push_back(trimmed(text.substr(begin, i - begin), " \t"));
            begin = i + 1;
        }
    }
    if (const auto last = trimmed(text.substr(begin), " \t");
        !last.empty()) {  // TOML, too, allows a comma after the last one
        parts.push_back(last);
    }
    return open == 0 ? std::optional(std::move(parts)) : std::nullopt;
}

bool is_inside(double value, const Range& range) {  // false also where the value is not a number
    return range.bounds == Bounds::closed ? value >= range.min && value <= range.max
                                          : value > range.min && value < range.max;
}

}  // namespace

SceneKey SceneKey::entry(std::size_t number) const {
    SceneKey one = *this;
    one.name += '[' + number_text(static_cast<std::int64_t>(number) + 1) + ']';
    one.is_optional = false;
    one.counts.erase(one.counts.begin());
    one.at.push_back(number);
    return one;
}

std::string SceneKey::allowed() const {
    if (is_list()) {
        const EntryCount& count = counts.front();
        const auto text = [](std::size_t number) { return number_text(static_cast<std::int64_t>(number)); };
        return "a list of " + text(count.least) +
               (count.most > count.least ? " to " + text(count.most) : "") + " entries, each " +
               entry(0).allowed();
    }
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
    at_member(scene, *this, [&](const auto& member) { value = value_in(member, at); });
    return value;
}

bool SceneKey::set(Scene& scene, const std::optional<SceneValue>& value) const {
    bool done = false;
    at_member(scene, *this, [&](auto& member) { done = assign(member, at, value); });
    return done;
}

const SceneKey* SceneKey::replacement(const Scene& scene) const {
    const auto keys = scene_keys();
    const auto list = std::ranges::find(keys, traits.replaced_by, &SceneKey::name);
    return list != keys.end() && list->value(scene) && list->has_effect(scene) ? &*list : nullptr;
}

bool SceneKey::has_effect(const Scene& scene) const {
    if (replacement(scene) != nullptr) {
        return false;
    }
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
    const std::string_view whole = without_entry(name);
    if (const std::string_view entry = name.substr(whole.size()); !entry.empty()) {
        auto list = scene_key_named(scene, whole);
        return list ? entry_named(scene, *std::move(list), entry) : list;
    }
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

std::string_view without_entry(std::string_view name) noexcept {
    return name.substr(0, name.find('['));
}

std::size_t entries_of(const SceneValue& value) noexcept {
    return std::visit(
        [](const auto& held) -> std::size_t {
            if constexpr (has_entries<std::decay_t<decltype(held)>>) {
                return held.size();
            } else {
                return 0;
            }
        },
        value);
}

namespace {

template <class Value>
std::string text_of(const Value& value, TextOfEntry* text) {
    if constexpr (has_entries<Value>) {
        std::string result;
        for (const auto& entry : value) {
            result += (result.empty() ? "[" : ", ") + text_of(entry, text);
        }
        return (result.empty() ? "[" : result) + "]";
    } else {
        return text(SceneValue(value));
    }
}

}  // namespace

std::string list_text(const SceneValue& list, TextOfEntry* text) {
    return std::visit([text](const auto& entries) { return text_of(entries, text); }, list);
}

std::string value_text(const SceneValue& value) {
    if (value.index() > 2) {
        return list_text(value, value_text);
    }
    if (const auto* text = std::get_if<std::string>(&value)) {
        return *text;
    }
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? number_text(*number) : number_text(std::get<std::int64_t>(value));
}

std::optional<Fault> count_fault(const SceneKey& key, std::size_t count) {
    const EntryCount& allowed = key.counts.front();
    return count >= allowed.least && count <= allowed.most
               ? std::nullopt
               : std::optional(Fault{
                     key.name,
                     number_text(static_cast<std::int64_t>(count)) + (count == 1 ? " entry" : " entries"),
                     key.allowed()});
}

SceneValue joined(const SceneKey& key, const std::vector<SceneValue>& entries) {
    if (key.counts.size() > 1) {
        std::vector<std::array<double, 3>> points(entries.size());
        for (std::size_t i = 0; i < entries.size(); ++i) {
            std::ranges::copy(std::get<std::vector<double>>(entries[i]), points[i].begin());
        }
        return points;
    }
    const auto list = [&](auto values) {
        for (const SceneValue& entry : entries) {
            values.push_back(std::get<typename decltype(values)::value_type>(entry));
        }
        return SceneValue(std::move(values));
    };
    return key.kind == ValueKind::word ? list(std::vector<std::string>()) : list(std::vector<double>());
}

std::optional<SceneValue> value_as(ValueKind kind, const SceneValue& value) {
    const auto* integer = std::get_if<std::int64_t>(&value);
    if (kind == ValueKind::number && integer != nullptr) {
        return static_cast<double>(*integer);
    }
    return static_cast<std::size_t>(kind) == value.index() ? std::optional(value) : std::nullopt;
}

std::optional<SceneValue> read_value(ValueKind kind, std::string_view text) {
    auto plain = kind == ValueKind::number    ? plain_number<double>(text)
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
    if (key.is_list()) {
        const auto parts = parts_of_list(text);
        return parts ? read_list(key, parts->size(),
                                 [&](const SceneKey& entry, std::size_t i) {
                                     return read_text(entry, (*parts)[i]);
                                 })
                     : tl::unexpected(Fault{key.name, quoted_briefly(text), key.allowed()});
    }
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
    if (const auto* text = std::get_if<std::string>(&value);
        text != nullptr && (key.kind != ValueKind::word || key.is_list())) {
        return read_allowed(scene, key, *text);
    }
    if (key.kind == ValueKind::number && std::holds_alternative<std::int64_t>(value)) {
        value = static_cast<double>(std::get<std::int64_t>(value));
    }
    if (key.is_list() != (entries_of(value) > 0) ||
        (!key.is_list() && static_cast<std::size_t>(key.kind) != value.index())) {
        return tl::unexpected(Fault{key.name, toml_text(value), key.allowed()});
    }
    if (auto fault = value_fault(scene, key, value)) {
        return tl::unexpected(*std::move(fault));
    }
    return value;
}

namespace {

/// The fault of the first wrong entry.
template <class Value>
std::optional<Fault> entry_fault(const Scene& scene, const SceneKey& key, const Value& value) {
    if constexpr (has_entries<Value>) {
        if (auto fault = count_fault(key, value.size())) {
            return fault;
        }
        const SceneKey first = key.entry(0);  // a key for each entry would take long
        for (std::size_t i = 0; i < value.size(); ++i) {
            if (entry_fault(scene, first, value[i])) {
                return entry_fault(scene, key.entry(i), value[i]);
            }
        }
        return std::nullopt;
    } else {
        return key.is_list() ? std::optional(Fault{key.name, value_text(value), key.allowed()})
                             : value_fault(scene, key, value);
    }
}

}  // namespace

std::optional<Fault> value_fault(const Scene& scene, const SceneKey& key, const SceneValue& value) {
    if (key.is_list()) {
        return std::visit([&](const auto& list) { return entry_fault(scene, key, list); }, value);
    }
    if (entries_of(value) > 0) {
        return Fault{key.name, value_text(value), key.allowed()};
    }
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
