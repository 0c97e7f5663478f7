#pragma once
// Stands in front of the TOML library. Scene text comes from anywhere, and toml++ 3.3.0 has crashes of its own, so nothing
// reaches it that a scene does not need. It aborts on NUL and has undefined behaviour on some non-ASCII text, a byte order mark
// after a line end among it. It recurses once per part of a dotted key, and 32 000 parts overflow the stack. (It limits the depth
// of brackets and braces itself, to 256.)

#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "core/scene/scene_key.hpp"

namespace hertzline {

/// Longer texts of scenes are refused [bytes].
inline constexpr std::size_t max_scene_bytes = std::size_t{32} << 20;  // a record of a million samples

/// Checks a text as any editor saves it, and returns it without byte order mark and comments, its lines ended by LF, in printable ASCII and
/// tabs. Comments and strings in double quotes are UTF-8, and what is not ASCII in a string is escaped. A line may hold 32 single dots.
/// The fault tells its line.
tl::expected<std::string, Fault> guarded_toml(std::string_view text);

}  // namespace hertzline
