#pragma once
// A key of a scene at run time: its allowed values, and functions that read, check, set and clear its value. The keys are the rows
// of scene_table.hpp.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "hertzline/scene.hpp"

namespace hertzline {

/// A value of a key: a number, an integer, or a word (of a choice, or the name of a material); or a list: of numbers, of words, of
/// points.
using SceneValue = std::variant<double, std::int64_t, std::string, std::vector<double>,
                                std::vector<std::string>, std::vector<std::array<double, 3>>>;

enum class ValueKind { number, integer, word };  // in the order of SceneValue

/// Whether a member of a scene, or a value, has entries.
template <class T>
struct HasEntries : std::false_type {};
template <class T>
struct HasEntries<std::vector<T>> : std::true_type {};
template <class T, std::size_t N>
struct HasEntries<std::array<T, N>> : std::true_type {};
template <class T>
inline constexpr bool has_entries = HasEntries<T>::value;

enum class Bounds { closed, open };

/// Of a key that takes any text [bytes].
inline constexpr std::size_t longest_text = 4096;

/// The numbers or integers that a key allows.
struct Range {
    double min = 0;
    double max = 0;
    std::string_view unit{};
    Bounds bounds = Bounds::closed;
};

/// Another key and its words, one of which a key needs to have an effect.
struct Need {
    std::string_view key{};  ///< empty: the key always has an effect
    std::array<std::string_view, 3> words{};
};

/// How many entries a list may have. One without entries is not given.
struct EntryCount {
    std::size_t least = 0;
    std::size_t most = 1;
};

/// When a hash depends on a key. Where keys that came later have their defaults, a scene has the hash that it had before, unless the
/// default means something new to those scenes on which the key has an effect.
enum class Hashed { always, when_changed, when_in_effect };

struct KeyTraits {
    std::string_view unset = "none";  ///< of an optional key: its meaning where it is not given
    Need needs = {};
    Hashed hashed = Hashed::always;
    MaterialSort sort = MaterialSort::solid;  ///< of the name of a material
    std::size_t most_entries = 0;             ///< of a list
    bool is_text = false;                     ///< any text, not a word
    bool reads_record = false;                ///< the record of a drive is read by it, once
    std::string_view each =
        {};  ///< of a list: the key that it replaces, and whose value an entry has that is not given
};

/// A row of the table.
struct KeyRow {
    std::string_view key;  ///< without its section: "preload_n"
    Range range = {};      ///< of a number or an integer
    std::string_view doc;  ///< its meaning, in Markdown
    KeyTraits traits = {};
};

/// A key that a scene has: one of scene_keys(), or of one of its own materials; or an entry of a list, which is set and read as a key
/// of its own.
struct SceneKey : KeyRow {
    std::string name = {};  ///< "chain.preload_n", "materials.mine.density_kg_per_m3", "end.thicknesses_m[2]"
    ValueKind kind = ValueKind::number;  ///< of a list: that of its entries
    bool is_optional = false;
    bool is_material = false;               ///< the word is the name of a material
    std::vector<std::string> words = {};    ///< of a choice
    std::optional<std::string> owner = {};  ///< the scene's own material that it belongs to
    std::size_t row = 0;                    ///< in the table
    std::vector<EntryCount> counts =
        {};  ///< none: a single value; one: a list, or a point; two: a list of points
    std::vector<std::size_t> at = {};  ///< of an entry: its place, from 0 on; two: in a list of points

    bool is_list() const noexcept { return !counts.empty(); }
    /// An entry of the list. @param number from 0 on; its name counts from 1
    SceneKey entry(std::size_t number) const;
    /// "chain", "materials.mine"
    std::string section() const { return name.substr(0, name.size() - key.size() - 1); }
    /// "an integer from 1 to 10000000"
    std::string allowed() const;

    /// Nothing where the scene does not give it.
    std::optional<SceneValue> value(const Scene& scene) const;
    /// False, and nothing is changed, where the key has no such word, or always has a value. @param value of the key's kind; nothing
    /// takes it back
    bool set(Scene& scene, const std::optional<SceneValue>& value) const;
    /// The list that the scene gives in the key's place, if it does.
    const SceneKey* replacement(const Scene& scene) const;
    /// Whether the key is one of [array] and the scene has a single chain.
    bool lacks_array(const Scene& scene) const;
    /// False where the scene lacks the array or has another word than the key needs, or gives a list that replaces it.
    bool has_effect(const Scene& scene) const;
};

/// Every key of a scene but those of its own materials, in the order of its file.
std::span<const SceneKey> scene_keys();

/// The keys of a scene's own material of that name; of a solid or a fluid as `material` is one.
std::vector<SceneKey> material_keys(const std::string& name, const Material& material);

/// Every key that the scene has, those of its own materials included.
std::vector<SceneKey> keys_of(const Scene& scene);

/// The key of that name, or a fault that suggests another one. An entry, "end.thicknesses_m[2]", is one that the scene has.
tl::expected<SceneKey, Fault> scene_key_named(const Scene& scene, std::string_view name);

/// The words that the key takes in this scene: of a choice, or the names of materials; none of a number.
std::vector<std::string> words_of(const Scene& scene, const SceneKey& key);

/// "number", "integer" or "word".
std::string_view word(ValueKind kind) noexcept;

/// The name without the entry in its brackets: "end.thicknesses_m" of "end.thicknesses_m[2]".
std::string_view without_entry(std::string_view name) noexcept;

/// The texts of a list's entries in brackets. @param text of one entry, a single value
using TextOfEntry = std::string(const SceneValue&);
std::string list_text(const SceneValue& list, TextOfEntry* text);

/// Whether it is a list, without entries, too.
bool is_list(const SceneValue& value) noexcept;

/// The value for a message, words without quotes; reads back to the same value.
std::string value_text(const SceneValue& value);

/// The single value as one of that kind, an integer as a number, too; nothing when it is of another kind.
std::optional<SceneValue> value_as(ValueKind kind, const SceneValue& value);

/// The text as a single value of that kind in TOML, where a word needs no quotes; nothing when it is none.
std::optional<SceneValue> read_value(ValueKind kind, std::string_view text);

/// The text as a value of the key, or its fault: a number with or without its unit ("3 um", units.hpp), an integer, a word, or a list
/// of them in brackets. Bounds and words are left to value_fault().
tl::expected<SceneValue, Fault> read_text(const SceneKey& key, std::string_view text);

/// The fault of numbers of which some have a unit and another one, not 0, has none: that is rarely meant in the base unit.
std::optional<Fault> unit_fault(const SceneKey& key, std::span<const std::string_view> numbers);

/// The list of `count` entries, or its fault: of their number, before one is read, or of one of them.
/// @param read gives the value of an entry's key, or its fault
template <class Read>
tl::expected<SceneValue, Fault> read_list(const SceneKey& key, std::size_t count, const Read& read);

/// The text as a value that the key allows, or its fault. @param scene has the materials
tl::expected<SceneValue, Fault> read_allowed(const Scene& scene, const SceneKey& key, std::string_view text);

/// The value as one that the key allows: integers are numbers, too, and a text may hold any value, as read_text() takes it.
tl::expected<SceneValue, Fault> allowed_value(const Scene& scene, const SceneKey& key, SceneValue value);

/// The fault of the value by itself: it is out of the key's bounds, or no such word. @param scene has the
/// materials @param value of the key's kind
std::optional<Fault> value_fault(const Scene& scene, const SceneKey& key, const SceneValue& value);

/// The fault of a list with so many entries.
std::optional<Fault> count_fault(const SceneKey& key, std::size_t count);

/// The values of its entries as a list of the key's kind.
SceneValue joined(const SceneKey& key, const std::vector<SceneValue>& entries);

template <class Read>
tl::expected<SceneValue, Fault> read_list(const SceneKey& key, std::size_t count, const Read& read) {
    if (auto fault = count_fault(key, count)) {
        return tl::unexpected(*std::move(fault));
    }
    std::vector<SceneValue> entries;
    for (std::size_t i = 0; i < count; ++i) {
        tl::expected<SceneValue, Fault> value = read(key.entry(i), i);
        if (!value) {
            return value;
        }
        entries.push_back(*std::move(value));
    }
    return joined(key, entries);
}

}  // namespace hertzline
