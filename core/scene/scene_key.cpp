#include "core/scene/scene_key.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "core/scene/scene_table.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

constexpr std::string_view materials = "materials.";

template <class T>
constexpr bool may_be_unset = false;
template <class T>
constexpr bool may_be_unset<std::optional<T>> = true;

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
        key.counts.push_back(is_list ? EntryCount{0, key.traits.most_entries}
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
        key.is_material = key.kind == ValueKind::word && !key.traits.is_text;
    }
}

/// A member of a scene: its place, and how it is read and set there.
struct SceneMember {
    std::ptrdiff_t offset;
    std::optional<SceneValue> (*value)(const void* member, EntryPath path);
    bool (*assign)(void* member, EntryPath path, const std::optional<SceneValue>& value);
};

/// The members in the order of the table. A key looks itself up here: to visit all rows for each key would take longer than many a run.
const std::vector<SceneMember>& scene_members() {
    // never destroyed, as scene_keys()
    static const auto& members = *new const std::vector<SceneMember>([scene = Scene{}] {
        std::vector<SceneMember> all;
        table::visit_scene(scene, [&]<class Member>(std::string_view, const Member& member, const KeyRow&) {
            all.push_back(
                {reinterpret_cast<const std::byte*>(&member) - reinterpret_cast<const std::byte*>(&scene),
                 [](const void* at, EntryPath path) {
                     return value_in(*static_cast<const Member*>(at), path);
                 },
                 [](void* at, EntryPath path, const std::optional<SceneValue>& value) {
                     return assign(*static_cast<Member*>(at), path, value);
                 }});
        });
        return all;
    }());
    return members;
}

/// Calls act(member) for the member of the scene's own material that the key belongs to, if there is one.
template <class AnyScene, class Act>
void at_own_member(AnyScene& scene, const SceneKey& key, const Act& act) {
    if (const auto own = scene.materials.find(*key.owner); own != scene.materials.end()) {
        table::visit_material(own->second, "", [&](std::string_view, auto& member, const KeyRow& row) {
            if (row.key == key.key) {
                act(member);
            }
        });
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

/// How many entries the list has; 0: the scene does not give it.
std::size_t entries_in(const std::optional<SceneValue>& list) {
    const auto size = [](const auto& held) -> std::size_t {
        if constexpr (has_entries<std::decay_t<decltype(held)>>) {
            return held.size();
        } else {
            return 0;
        }
    };
    return list ? std::visit(size, *list) : 0;
}

/// The whole number from 1 on that an entry's name has in its brackets; 0: none.
std::size_t entry_number(std::string_view text) {
    return text.starts_with('0') ? 0 : parsed_number<std::size_t>(text).value_or(0);
}

/// The list as it would be given so that nothing changes, with that entry; nothing where no such list suits the scene.
std::optional<SceneValue> list_given(const Scene& scene, const SceneKey& key, std::size_t number) {
    std::size_t count = key.section() == "chain" ? static_cast<std::size_t>(scene.chain.spheres) : number;
    for (const SceneKey& other : scene_keys()) {  // lists of a section have an entry each for the same bodies
        if (other.is_list() && other.section() == key.section()) {
            count = std::max(count, entries_in(other.value(scene)));
        }
    }
    count = std::min(count, key.counts.front().most);
    if (number == 0 || number > count || count > max_elements) {
        return std::nullopt;
    }
    SceneValue one = 0.0;
    if (key.counts.size() > 1) {
        one = std::vector<double>(key.counts.back().most);
    } else if (!key.traits.each.empty()) {
        one = *std::ranges::find(scene_keys(), key.traits.each, &SceneKey::name)->value(scene);
    }
    SceneValue list = joined(key, std::vector(count, one));
    Scene with_list = scene;
    key.set(with_list, list);
    return validate(with_list).empty() ? std::optional(std::move(list)) : std::nullopt;
}

/// The remedy where the scene does not give a list whose entry is named.
std::string advice_to_give(const Scene& scene, const SceneKey& key, std::size_t number) {
    constexpr std::size_t longest = 1000;
    const auto list = list_given(scene, key, number);
    const std::string text = list ? value_text(*list) : "";
    return "none: the scene does not give " + key.name + "; first give the whole list" +
           (text.empty() || text.size() > longest ? "" : ", as '" + key.name + '=' + text + '\'');
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
        const std::size_t count = entries_in(key.value(scene));
        if (number == 0 || number > count) {
            const std::string last = number_text(static_cast<std::int64_t>(count));
            return tl::unexpected(Fault{
                printable(name),
                number > 0 ? "entry " + number_text(static_cast<std::int64_t>(number)) : "no entry",
                count == 0 ? advice_to_give(scene, key, number)
                           : key.name + "[1]" + (count > 1 ? " to " + key.name + "[" + last + "]" : "")});
        }
        key = key.entry(number - 1);
        entry.remove_prefix(end + 1);
    }
    return key;
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
        return std::string("a list [A, B, ...] of ") + (count.most > count.least ? "at most " : "") +
               number_text(static_cast<std::int64_t>(count.most)) + " entries, each " + entry(0).allowed();
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
    if (traits.is_text) {
        return "a text in UTF-8 of at most " + number_text(std::int64_t{longest_text}) +
               " bytes, none of them 0";
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
    if (!owner) {
        const SceneMember& member = scene_members()[row];
        return member.value(reinterpret_cast<const std::byte*>(&scene) + member.offset, at);
    }
    std::optional<SceneValue> value;
    at_own_member(scene, *this, [&](const auto& member) { value = value_in(member, at); });
    return value;
}

bool SceneKey::set(Scene& scene, const std::optional<SceneValue>& value) const {
    if (!owner) {
        const SceneMember& member = scene_members()[row];
        return member.assign(reinterpret_cast<std::byte*>(&scene) + member.offset, at, value);
    }
    bool done = false;
    at_own_member(scene, *this, [&](auto& member) { done = assign(member, at, value); });
    return done;
}

const SceneKey* SceneKey::replacement(const Scene& scene) const {
    const auto keys = scene_keys();
    const auto list = std::ranges::find_if(keys, [&](const SceneKey& other) {
        return other.traits.each == name && other.value(scene) && other.has_effect(scene);
    });
    return list != keys.end() ? &*list : nullptr;
}

bool SceneKey::lacks_array(const Scene& scene) const {
    return section() == "array" && scene.array.x_m.empty();
}

bool SceneKey::has_effect(const Scene& scene) const {
    if (lacks_array(scene) || replacement(scene) != nullptr) {
        return false;
    }
    if (traits.needs.key.empty()) {
        return true;
    }
    const auto keys = scene_keys();
    const auto needed = std::ranges::find(keys, traits.needs.key, &SceneKey::name);
    if (needed == keys.end()) {
        return true;
    }
    const auto word = needed->value(scene);
    return std::ranges::any_of(traits.needs.words,
                               [&](std::string_view one) { return word == SceneValue(std::string(one)); });
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

std::string_view without_entry(std::string_view name) noexcept {
    return name.substr(0, name.find('['));
}

}  // namespace hertzline
