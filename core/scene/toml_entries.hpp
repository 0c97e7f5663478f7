#pragma once
// TOML text to a flat list of entries, behind the guard. The only place that meets the TOML library.

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hertzline {

/// A section or a table.
struct TomlTable {};

/// A value of a type that no scene key takes: a truth value, a date, an array.
struct TomlOther {
    std::string description;
};

using TomlValue = std::variant<std::int64_t, double, std::string, TomlTable, TomlOther>;

/// One key of the text: a section ("drive"), a key of a section, or a key of a table in a section.
struct TomlEntry {
    std::vector<std::string> path;  ///< one to three parts
    TomlValue value;
    int line = 0;  ///< counted from 1
};

/// Why a text was refused.
struct TomlRefusal {
    int line = 0;  ///< counted from 1
    std::string found;
    std::string allowed;
};

using TomlEntries = std::variant<std::vector<TomlEntry>, TomlRefusal>;

/// The entries of a whole scene file; sections come before what is in them.
TomlEntries toml_entries(std::string_view text);

/// A single value; a bare word that means nothing else in TOML is a string.
std::variant<TomlValue, TomlRefusal> toml_value(std::string_view text);

/// The value as a message shows it.
std::string value_text(const TomlValue& value);

}  // namespace hertzline
