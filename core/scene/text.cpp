#include "core/scene/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <limits>
#include <numeric>
#include <vector>

namespace hertzline {

namespace {

// Longer texts are cut in messages, and are too long to resemble any name that the program knows.
constexpr std::size_t max_shown = 60;

template <class Number>
std::string shortest(Number value) {
    std::array<char, 32> buffer{};  // the longest double takes 24 characters
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    return {buffer.data(), end};
}

struct Codes {
    char32_t first;
    char32_t last;
};

// The characters that a terminal acts on, or that it does not show: control characters (C0, DEL, C1), ends of lines and
// paragraphs, marks, embeddings, overrides and isolates of the bidirectional algorithm (Unicode Standard Annex 9), and those
// that Unicode calls default ignorable, but for the joiners U+200C and U+200D and the variation selectors, which belong to the
// writing of some languages; noncharacters.
constexpr std::array<Codes, 13> not_plain{{{0, 0x1F},
                                           {0x7F, 0x9F},
                                           {0xAD, 0xAD},
                                           {0x61C, 0x61C},
                                           {0x180E, 0x180E},
                                           {0x200B, 0x200B},
                                           {0x200E, 0x200F},
                                           {0x2028, 0x202E},
                                           {0x2060, 0x206F},
                                           {0xFEFF, 0xFEFF},
                                           {0xFFF9, 0xFFFB},
                                           {0xFFFE, 0xFFFF},
                                           {0xE0000, 0xE00FF}}};

constexpr bool is_plain_code(char32_t code) {
    return std::ranges::none_of(
        not_plain, [=](const Codes& codes) { return code >= codes.first && code <= codes.last; });
}

// Takes a character, or a byte that is none, off the text. The text is not empty.
struct Taken {
    std::string_view bytes;
    bool is_plain = false;
    char32_t code = 0;
};

Taken take_character(std::string_view& text) {
    const Character first = first_character(text);
    const Taken taken{text.substr(0, std::max<std::size_t>(first.bytes, 1)),
                      first.bytes > 0 && is_plain_code(first.code),
                      first.bytes > 0 ? first.code : static_cast<unsigned char>(text.front())};
    text.remove_prefix(taken.bytes.size());
    return taken;
}

// Whole characters from the beginning of the text, of so many bytes at most.
std::string_view beginning(std::string_view text, std::size_t max_length) {
    const auto goes_on = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80; };
    std::size_t length = std::min(text.size(), max_length);
    for (int i = 0; i < 3 && length > 0 && length < text.size() && goes_on(text[length]); ++i) {
        --length;
    }
    return text.substr(0, length);
}

std::string_view last_part(std::string_view key) {
    return key.substr(key.rfind('.') + 1);  // npos + 1 is 0: a key without a dot is its own last part
}

// How unlike the two keys are: edits of the last part, plus one for another section.
std::size_t unlikeness(std::string_view text, std::string_view candidate) {
    const std::string_view name = last_part(text);
    const std::string_view other = last_part(candidate);
    const std::string_view section = text.substr(0, text.size() - name.size());
    const std::string_view other_section = candidate.substr(0, candidate.size() - other.size());
    const bool only_the_unit_is_missing = name.size() >= 4 && other.starts_with(name);
    const std::size_t edits = only_the_unit_is_missing ? 1 : edit_distance(name, other);
    return edits + std::min<std::size_t>(edit_distance(section, other_section), 1);
}

// Half of a name is often all that one remembers. nullptr when none or several contain it.
const std::string* only_one_that_contains(std::string_view text, std::span<const std::string> candidates) {
    constexpr std::size_t shortest_part = 4;
    const std::string* only = nullptr;
    for (const std::string& candidate : candidates) {
        if (text.size() >= shortest_part && candidate.find(text) != std::string::npos) {
            if (only != nullptr) {
                return nullptr;
            }
            only = &candidate;
        }
    }
    return only;
}

}  // namespace

std::string enumeration(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
    }
    return text;
}

std::string number_text(double value) {
    return shortest(value);
}

std::string number_text(std::int64_t value) {
    return shortest(value);
}

std::string rounded_text(double value, int digits) {
    std::array<char, 32> text{};
    const int length = std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    return {text.data(), static_cast<std::size_t>(length)};
}

Character first_character(std::string_view text) noexcept {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) {
        return {1, first};
    }
    const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
    if (bytes == 0 || first > 0xF4 || text.size() < bytes) {
        return {};
    }
    char32_t code = first & (0xFFU >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xC0U) != 0x80) {
            return {};
        }
        code = code << 6U | (byte(i) & 0x3FU);
    }
    constexpr char32_t surrogates = 0xD800;
    constexpr char32_t after_surrogates = 0xE000;
    const bool too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
    const bool none = too_long || code > 0x10FFFF || (code >= surrogates && code < after_surrogates);
    return none ? Character{} : Character{bytes, code};
}

bool is_utf8(std::string_view text) noexcept {
    while (!text.empty()) {
        const std::size_t bytes = first_character(text).bytes;
        if (bytes == 0) {
            return false;
        }
        text.remove_prefix(bytes);
    }
    return true;
}

bool is_plain(std::string_view text) noexcept {
    while (!text.empty()) {
        if (!take_character(text).is_plain) {
            return false;
        }
    }
    return true;
}

std::string escaped(char32_t code) {
    std::array<char, 16> text{};
    const int length = std::snprintf(text.data(), text.size(), code < 0x10000 ? "\\u%04X" : "\\U%08X",
                                     static_cast<unsigned>(code));
    return {text.data(), static_cast<std::size_t>(length)};
}

std::string quoted(std::string_view text) {
    std::string result = "\"";
    while (!text.empty()) {
        const Taken next = take_character(text);
        if (next.bytes == "\"" || next.bytes == "\\") {
            result += '\\';
        }
        result += next.is_plain ? std::string(next.bytes) : escaped(next.code);
    }
    return result + '"';
}

std::string quoted_briefly(std::string_view text) {
    std::string_view part = beginning(text, max_shown);
    std::string shown = quoted(part);
    while (shown.size() > 2 * max_shown + 2) {  // of characters that are written as \u00FF
        part = beginning(text, part.size() - 1);
        shown = quoted(part);
    }
    return part.size() == text.size() ? shown : shown + "...";
}

std::string printable(std::string_view text, std::size_t max_length) {
    std::string result;
    for (std::string_view rest = beginning(text, max_length); !rest.empty();) {
        const Taken next = take_character(rest);
        result += next.is_plain ? next.bytes : "?";
    }
    return text.size() <= max_length ? result : result + "...";
}

std::string printable_whole(std::string_view text) {
    return printable(text, text.size());
}

std::string column_text(std::string_view text, std::size_t max_length) {
    std::string result;
    for (std::string_view rest = beginning(text, max_length); !rest.empty();) {
        const Taken next = take_character(rest);
        const bool is_micro = next.code == 0xB5 || next.code == 0x3BC;
        result += is_micro ? "u" : next.is_plain ? next.bytes : "?";
    }
    return text.size() <= max_length ? result : result + "...";
}

std::string lower_case(std::string_view text) {
    std::string small(text);
    std::ranges::transform(small, small.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return small;
}

bool is_bare_key(std::string_view text) noexcept {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    });
}

std::string key_part(std::string_view text) {
    return is_bare_key(text) ? std::string(text) : quoted(text);
}

std::string_view trimmed(std::string_view text, std::string_view blanks) noexcept {
    const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
    text.remove_prefix(begin);
    return text.substr(0, text.find_last_not_of(blanks) + 1);  // npos + 1 is 0: nothing is left
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
        parts.push_back(text.substr(0, end));
        text.remove_prefix(end + 1);
    }
    parts.push_back(text);
    return parts;
}

std::string comma_separated(std::span<const std::string> words) {
    std::string result;
    for (const std::string& word : words) {
        result += (result.empty() ? "" : ", ") + word;
    }
    return result;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // row[j]: distance from a's first i characters to b's first j
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
        }
    }
    return row.back();
}

std::string suggestion(std::string_view text, std::span<const std::string> candidates) {
    if (text.empty() || text.size() > max_shown) {
        return "";
    }
    const std::string* nearest = nullptr;
    std::size_t smallest = std::numeric_limits<std::size_t>::max();
    for (const std::string& candidate : candidates) {
        if (const std::size_t distance = unlikeness(text, candidate); distance < smallest) {
            smallest = distance;
            nearest = &candidate;
        }
    }
    // One edit in three characters still looks like a slip of the fingers; more looks like another word.
    const std::size_t tolerated = std::max<std::size_t>(2, last_part(text).size() / 3);
    const std::string* const meant =
        smallest <= tolerated ? nearest : only_one_that_contains(text, candidates);
    return meant != nullptr ? "; did you mean '" + *meant + "'?" : "";
}

std::string hash_text(std::string_view bytes) {
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const char c : bytes) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3;
    }
    constexpr std::string_view hex = "0123456789abcdef";
    std::string digits;
    for (int shift = 60; shift >= 0; shift -= 4) {
        digits += hex[(hash >> shift) & 0xF];
    }
    return digits;
}

}  // namespace hertzline
