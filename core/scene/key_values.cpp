// Values of keys: their texts, how they are read, and their faults.
#include <algorithm>
#include <array>
#include <utility>

#include "core/scene/scene_key.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"
#include "core/scene/units.hpp"

namespace hertzline {

namespace {

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

std::string_view word(ValueKind kind) noexcept {
    return std::array{"number", "integer", "word"}[static_cast<std::size_t>(kind)];
}

bool is_list(const SceneValue& value) noexcept {
    return value.index() > 2;
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
    if (is_list(value)) {
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
    // without a look at TOML's other ways to write a number
    if (kind == ValueKind::number) {
        if (const auto plain = parsed_number<double>(text)) {
            return *plain;
        }
    } else if (kind == ValueKind::integer) {
        if (const auto plain = parsed_number<std::int64_t>(text)) {
            return *plain;
        }
    }
    const auto found = toml_value(text);
    const auto* const given = found ? std::get_if<SceneValue>(&*found) : nullptr;
    return given != nullptr ? value_as(kind, *given) : std::nullopt;
}

std::optional<Fault> unit_fault(const SceneKey& key, std::span<const std::string_view> numbers) {
    if (std::ranges::none_of(numbers, has_unit)) {
        return std::nullopt;
    }
    for (const std::string_view number : numbers) {
        if (parsed_number<double>(number).value_or(0) != 0) {
            return Fault{key.name, quoted_briefly(number) + " beside a number with a unit",
                         "a unit after each number but 0"};
        }
    }
    return std::nullopt;
}

tl::expected<SceneValue, Fault> read_text(const SceneKey& key, std::string_view text) {
    if (key.traits.is_text) {
        const auto given = read_value(ValueKind::word, text);
        return given ? *given : SceneValue(std::string(text));
    }
    if (key.is_list()) {
        const auto parts = parts_of_list(text);
        if (auto fault = parts ? unit_fault(key, *parts) : std::nullopt) {
            return tl::unexpected(*std::move(fault));
        }
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
            fault->found = !key.is_list() && has_unit(text) ? quoted_briefly(text) : fault->found;
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
    if (key.traits.is_text && value.index() < 2) {
        value = value_text(value);
    }
    if (key.kind == ValueKind::number && std::holds_alternative<std::int64_t>(value)) {
        value = static_cast<double>(std::get<std::int64_t>(value));
    }
    if (key.is_list() != is_list(value) ||
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
    if (is_list(value)) {
        return Fault{key.name, value_text(value), key.allowed()};
    }
    if (const auto* text = std::get_if<std::string>(&value)) {
        if (key.is_material) {
            return material_fault(scene, key, *text);
        }
        if (key.traits.is_text) {
            return !text->empty() && text->size() <= longest_text && is_utf8(*text) &&
                           text->find('\0') == std::string::npos
                       ? std::nullopt
                       : std::optional(Fault{key.name, quoted_briefly(*text), key.allowed()});
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
