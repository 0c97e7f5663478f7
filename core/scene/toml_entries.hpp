#pragma once
// TOML text to a flat list of entries, behind the guard. The only place that meets the TOML library.

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/scene_key.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// A section or a table.
struct TomlTable {};

/// A value of a type that no scene key takes: a boolean, a date.
struct TomlOther {
    std::string description;
};

struct TomlArray;

/// A SceneValue here is a single value.
using TomlValue = std::variant<SceneValue, TomlTable, TomlOther, TomlArray>;

struct TomlArray {
    std::vector<TomlValue> entries;
};

/// One key of the text: a section ("drive"), a key of a section, or a key of a table in a section.
struct TomlEntry {
    std::vector<std::string> path;  ///< one to three parts
    TomlValue value;
    int line = 0;  ///< counted from 1
};

/// The entries of a whole scene file; sections come before their keys. A fault tells its line; the name
/// of the file is for the caller to add.
tl::expected<std::vector<TomlEntry>, Fault> toml_entries(std::string_view text);

/// A single value; a bare word that means nothing else in TOML is a string. Nothing where the text is no TOML.
std::optional<TomlValue> toml_value(std::string_view text);

/// The value as one of the key, or its fault: its kind is another one. A text may be a number with its unit. Bounds and words are left
/// to value_fault().
tl::expected<SceneValue, Fault> value_of(const SceneKey& key, const TomlValue& value);

/// The value as TOML: 5.0 has a point and the integer 5 has none; words are quoted.
std::string toml_text(const SceneValue& value);

/// The value as a message shows it: TOML, cut where it is long.
std::string found_text(const TomlValue& value);

}  // namespace hertzline
