#include "core/scene/toml_entries.hpp"

#include <algorithm>
#include <array>
#include <optional>

// toml++ is compiled here, not linked, which would make each start of a program longer. Its assertions abort on "[+a]", which it
// reports as an error anyway.
#define TOML_ASSERT(condition) static_assert(true)
#include <toml++/toml.h>

#include "core/scene/text.hpp"
#include "core/scene/toml_guard.hpp"
#include "core/scene/units.hpp"

namespace hertzline {

namespace {

Fault fault_in_line(int line, std::string found, std::string allowed) {
    return {"", std::move(found), std::move(allowed), Place{"", line}};
}

TomlValue value_in(const toml::node& node) {
    if (const auto* integer = node.as_integer()) {
        return SceneValue(integer->get());
    }
    if (const auto* number = node.as_floating_point()) {
        return SceneValue(number->get());
    }
    if (const auto* text = node.as_string()) {
        return SceneValue(text->get());
    }
    if (const auto* boolean = node.as_boolean()) {
        return TomlOther{boolean->get() ? "true" : "false"};
    }
    if (node.is_table()) {
        return TomlTable{};
    }
    if (const auto* array = node.as_array()) {  // the parser bounds how deep they lie in one another
        TomlArray list;
        for (const toml::node& entry : *array) {
            list.entries.push_back(value_in(entry));
        }
        return list;
    }
    return TomlOther{"a date or time"};
}

void append_entries(const toml::table& table, const std::vector<std::string>& parents,
                    std::vector<TomlEntry>& entries) {
    constexpr std::size_t max_depth = 3;  // materials.NAME.key
    for (const auto& [key, node] : table) {
        auto path = parents;
        path.emplace_back(key.str());
        entries.push_back({path, value_in(node), static_cast<int>(key.source().begin.line)});
        if (node.is_table() && path.size() < max_depth) {
            append_entries(*node.as_table(), path, entries);
        }
    }
}

Fault syntax_error(const toml::parse_error& error) {
    constexpr std::string_view preamble = "Error while parsing ";
    std::string_view what = error.description();
    what.remove_prefix(what.starts_with(preamble) ? preamble.size() : 0);
    // printable(): the description quotes the text with its escapes undone.
    return fault_in_line(static_cast<int>(error.source().begin.line), "a syntax error in " + printable(what),
                         "TOML (numbers in SI units, as 5e-4, or in quotes with their unit, as "
                         "\"0.5 mm\"; words in quotes, as \"wall\"), see https://toml.io");
}

// toml++ as Debian builds it reports by throwing; nothing but this function sees that.
tl::expected<toml::table, Fault> parsed(std::string_view text) {
    const auto guarded = guarded_toml(text);
    if (!guarded) {
        return tl::unexpected(guarded.error());
    }
    try {
        return toml::parse(*guarded);
    } catch (const toml::parse_error& error) {
        return tl::unexpected(syntax_error(error));
    }
}

// For TOML these words are values by themselves.
bool is_toml_word(std::string_view text) {
    constexpr std::array<std::string_view, 4> words{"true", "false", "inf", "nan"};
    return std::find(words.begin(), words.end(), text) != words.end();
}

}  // namespace

tl::expected<std::vector<TomlEntry>, Fault> toml_entries(std::string_view text) {
    return parsed(text).map([](const toml::table& table) {
        std::vector<TomlEntry> entries;
        append_entries(table, {}, entries);
        return entries;
    });
}

std::optional<TomlValue> toml_value(std::string_view text) {
    const bool starts_like_a_word = !text.empty() && text[0] != '-' && !(text[0] >= '0' && text[0] <= '9');
    if (starts_like_a_word && is_bare_key(text) && !is_toml_word(text)) {
        return TomlValue{SceneValue(std::string(text))};
    }
    // A line end would begin further keys. A comment is harmless but never meant: no value needs a '#'.
    if (text.find_first_of("\r\n#") != std::string_view::npos) {
        return std::nullopt;
    }
    const auto table = parsed("value = " + std::string(text));
    return table ? std::optional(value_in(*table->get("value"))) : std::nullopt;
}

tl::expected<SceneValue, Fault> value_of(const SceneKey& key, const TomlValue& value) {
    const auto* const single = std::get_if<SceneValue>(&value);
    const auto* const text = single != nullptr ? std::get_if<std::string>(single) : nullptr;
    if (text != nullptr && (key.is_list() || (key.kind != ValueKind::word && has_unit(*text)))) {
        return read_text(key, *text);
    }
    if (const auto* list = std::get_if<TomlArray>(&value); list != nullptr && key.is_list()) {
        return read_list(key, list->entries.size(), [&](const SceneKey& entry, std::size_t i) {
            return value_of(entry, list->entries[i]);
        });
    }
    if (key.traits.is_text && single != nullptr && single->index() < 2) {
        return SceneValue(value_text(*single));  // the number of a column
    }
    const auto found = single != nullptr && !key.is_list() ? value_as(key.kind, *single) : std::nullopt;
    return found ? tl::expected<SceneValue, Fault>(*found)
                 : tl::unexpected(Fault{key.name, found_text(value), key.allowed()});
}

std::string toml_text(const SceneValue& value) {
    if (is_list(value)) {
        return list_text(value, toml_text);
    }
    if (const auto* text = std::get_if<std::string>(&value)) {
        return hertzline::quoted(*text);
    }
    // a number is written as a float, so that a reader of any kind sees its type; -0 equals 0: one text for both
    const auto* number = std::get_if<double>(&value);
    const std::string text = number != nullptr && *number == 0 ? "0" : value_text(value);
    const bool whole = text.find_first_of(".eni") == std::string::npos;  // n, i: nan, inf
    return whole && std::holds_alternative<double>(value) ? text + ".0" : text;
}

std::string found_text(const TomlValue& value) {
    if (const auto* other = std::get_if<TomlOther>(&value)) {
        return other->description;
    }
    if (std::holds_alternative<TomlArray>(value)) {
        return "an array";
    }
    const auto* given = std::get_if<SceneValue>(&value);
    if (given == nullptr) {
        return "a table";
    }
    const auto* text = std::get_if<std::string>(given);
    return text != nullptr ? quoted_briefly(*text) : toml_text(*given);
}

}  // namespace hertzline
