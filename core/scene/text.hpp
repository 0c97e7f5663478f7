#pragma once
// Values as text, for messages and for scene files. Nothing here depends on the locale.

#include <charconv>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace hertzline {

/// Shortest decimal text that reads back to exactly the same number: "0.0005", "73000", "1e-09", "inf".
std::string number_text(double value);
std::string number_text(std::int64_t value);

/// The number with so many significant digits.
std::string rounded_text(double value, int digits);

/// The number that the whole text is, as std::from_chars reads it: without blanks, units or a plus sign.
template <class Number>
std::optional<Number> parsed_number(std::string_view text) noexcept {
    Number number{};
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, number);
    return error == std::errc{} && stopped == end ? std::optional(number) : std::nullopt;
}

/// A character in UTF-8.
struct Character {
    std::size_t bytes = 0;  ///< 0: not UTF-8
    char32_t code = 0;
};

/// The first character of a text that is not empty.
Character first_character(std::string_view text) noexcept;

/// Whether the text is UTF-8.
bool is_utf8(std::string_view text) noexcept;

/// Whether the text is UTF-8 without invisible characters and those that a terminal acts on: control characters, ends of lines
/// and paragraphs, changes of the direction of writing.
bool is_plain(std::string_view text) noexcept;

/// The character as an escape of TOML: "\u00FC".
std::string escaped(char32_t code);

/// The text between double quotes, with all that is not plain escaped: a TOML string, safe on a terminal.
std::string quoted(std::string_view text);

/// quoted(), shortened for a message.
std::string quoted_briefly(std::string_view text);

/// The text without quotes, for a message: all that is not plain becomes '?', and a longer text is cut [bytes].
std::string printable(std::string_view text, std::size_t max_length = 120);

/// printable(), not cut: for the names of files.
std::string printable_whole(std::string_view text);

/// printable(), with u for either sign of micro (in UTF-8 or Latin-1): for the names and units of columns.
std::string column_text(std::string_view text, std::size_t max_length = 120);

/// Whether TOML accepts the text as a key without quotes: letters, digits, '_' and '-'.
bool is_bare_key(std::string_view text) noexcept;

/// The text as one part of a dotted TOML key: as it is, or quoted where it must be.
std::string key_part(std::string_view text);

/// The text without the blanks around it.
std::string_view trimmed(std::string_view text, std::string_view blanks) noexcept;

/// The parts between the separators, one more than there are separators.
std::vector<std::string_view> split(std::string_view text, char separator);

/// The text with small letters in place of the capitals of ASCII.
std::string lower_case(std::string_view text);

/// The words in a row, separated by ", ".
std::string comma_separated(std::span<const std::string> words);

/// Number of characters to insert, delete or replace to turn a into b (Levenshtein distance).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// "; did you mean 'x'?" with the candidate x that resembles the text most; empty when none does. A dotted
/// text also resembles the candidates that share its last part, or begin with it ("end.damping").
std::string suggestion(std::string_view text, std::span<const std::string> candidates);

/// The FNV-1a hash of the bytes, 64 bits as 16 hexadecimal digits (Fowler, Noll, Vo: http://www.isthe.com/chongo/tech/comp/fnv/).
std::string hash_text(std::string_view bytes);

/// "steel", "steel and pyrex", "steel, pyrex and acrylic"
std::string enumeration(const std::vector<std::string>& names);

}  // namespace hertzline
