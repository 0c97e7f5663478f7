#pragma once
// One key of a scene as something that varies: what it takes, and how a value is read, judged and set.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/scene.hpp"

namespace hertzline {

/// A value of a key: a number, an integer, or a word (of a choice, or the name of a material).
using SceneValue = std::variant<double, std::int64_t, std::string>;

/// The value as a scene file has it, words without quotes; reads back to the same value.
std::string value_text(const SceneValue& value);

enum class ValueKind { number, integer, word };

/// A key that a scene has: one of scene_fields.hpp, or of one of its own materials.
struct SceneKeyInfo {
    std::string name;  ///< "chain.preload_n", "materials.mine.density_kg_per_m3"
    ValueKind kind = ValueKind::number;
    std::string unit;                                  ///< of a number; may be empty
    std::string allowed;                               ///< as messages have it
    std::optional<double> minimum = {}, maximum = {};  ///< of a number or an integer
    std::vector<std::string> words = {};               ///< that there are
};

/// Every key that the scene has, those of its own materials included.
std::vector<std::string> scene_key_names(const Scene& scene);

/// The key's value; nothing where it is not given, or there is no such key.
std::optional<SceneValue> value_of(const Scene& scene, std::string_view key);

/// Takes the key's value back; false where the key always has one.
bool unset_value(Scene& scene, std::string_view key);

/// The key of that name, or a fault that suggests another one.
tl::expected<SceneKeyInfo, Fault> scene_key_named(const Scene& scene, std::string_view name);

/// The text as a value of the key, as --set takes it, or what is wrong with it. Whether the key allows the value is for
/// value_fault() to say.
tl::expected<SceneValue, Fault> read_value(const SceneKeyInfo& key, std::string_view text);

/// What is wrong with the value whatever else the scene says: out of the key's bounds, no such word. @param scene has the
/// materials
std::optional<Fault> value_fault(const Scene& scene, const SceneKeyInfo& key, const SceneValue& value);

/// Sets the key. Words that there are not leave it as it is.
void set_value(Scene& scene, std::string_view key, const SceneValue& value);

}  // namespace hertzline
