#include "studies/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/scene/text.hpp"

namespace hertzline::studies {

namespace {

/// The form of the values of a key.
std::string form_of(std::string_view key, Sampling sampling) {
    return fmt::format("{0}=FROM..TO{1}[:lin|log] or {0}=A,B,C{2}", key,
                       sampling == Sampling::grid ? ":COUNT" : "",
                       sampling == Sampling::grid ? "" : ", without a count");
}

std::string_view without_blanks(std::string_view text) {
    return trimmed(text, " \t");
}

double number_of(const SceneValue& value) {
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? *number : static_cast<double>(std::get<std::int64_t>(value));
}

SceneValue value_of(const SceneKey& key, double number) {
    return key.kind == ValueKind::integer ? SceneValue(static_cast<std::int64_t>(std::llround(number)))
                                          : SceneValue(number);
}

/// Reads one option or list of values; its faults lack the place.
class AxisReader {
public:
    AxisReader(const Scene& scene, Sampling sampling) : scene_(scene), sampling_(sampling) {}

    std::optional<Axis> read(std::string_view option);
    std::optional<Axis> read(SceneKey key, std::string_view text);
    std::optional<Axis> read(std::string_view key, std::span<const SceneValue> values);

    std::vector<Fault> faults;

private:
    void refuse(std::string_view found, std::string allowed) {
        faults.push_back({axis_.key.name, quoted_briefly(found), std::move(allowed)});
    }
    bool find_key(std::string_view name);
    std::optional<SceneValue> value(std::string_view text);
    void add_to_list(tl::expected<SceneValue, Fault> value, std::string_view text = {});
    void refuse_without_unit(std::span<const std::string_view> numbers);
    void read_list(std::string_view text);
    void read_range(std::string_view text);
    void read_count(std::string_view text);
    void refuse_repeated_integers();

    const Scene& scene_;
    Sampling sampling_;
    Axis axis_;
    std::set<SceneValue> listed_;
};

bool AxisReader::find_key(std::string_view name) {
    auto key = varied_key(scene_, name);
    if (!key) {
        faults.push_back(std::move(key).error());
        return false;
    }
    axis_.key = *std::move(key);
    return true;
}

std::optional<SceneValue> AxisReader::value(std::string_view text) {
    auto value = read_allowed(scene_, axis_.key, text);
    if (!value) {
        faults.push_back(std::move(value).error());
        return std::nullopt;
    }
    return *std::move(value);
}

/// @param text empty: the value was not read from one
void AxisReader::add_to_list(tl::expected<SceneValue, Fault> value, std::string_view text) {
    if (!value) {
        faults.push_back(std::move(value).error());
        return;
    }
    if (!listed_.insert(*value).second) {
        refuse(text.empty() ? value_text(*value) : std::string(text), "each value once");
    }
    axis_.list.push_back(*std::move(value));
    axis_.count = static_cast<std::int64_t>(axis_.list.size());
}

void AxisReader::refuse_without_unit(std::span<const std::string_view> numbers) {
    if (auto fault = unit_fault(axis_.key, numbers)) {
        faults.push_back(*std::move(fault));
    }
}

void AxisReader::read_list(std::string_view text) {
    std::vector<std::string_view> parts = split(text, ',');
    std::ranges::transform(parts, parts.begin(), without_blanks);
    refuse_without_unit(parts);
    for (const std::string_view part : parts) {
        add_to_list(read_allowed(scene_, axis_.key, part), part);
        if (faults.size() == max_faults) {
            return;
        }
    }
}

void AxisReader::read_count(std::string_view text) {
    const auto count = read_value(ValueKind::integer, text);
    const auto* number = count ? std::get_if<std::int64_t>(&*count) : nullptr;
    if (number == nullptr || *number < 2 || *number > max_points) {
        refuse(text, "a count from 2 to " + number_text(max_points));
        return;
    }
    axis_.count = *number;
}

/// Refuses a range whose rounded integers repeat.
void AxisReader::refuse_repeated_integers() {
    if (axis_.key.kind != ValueKind::integer || sampling_ == Sampling::anywhere) {
        return;
    }
    if (static_cast<double>(axis_.count) > axis_.to - axis_.from + 1) {
        refuse(
            number_text(axis_.count) + " values",
            "at most one for each integer from " + number_text(axis_.from) + " to " + number_text(axis_.to));
        return;
    }
    for (std::int64_t i = 1; i < axis_.count; ++i) {
        if (axis_.value(i) == axis_.value(i - 1)) {
            refuse(value_text(axis_.value(i)) + " twice",
                   "fewer values, or a list: integers of a range are rounded");
            return;
        }
    }
}

void AxisReader::read_range(std::string_view text) {
    std::vector<std::string_view> parts = split(text, ':');
    std::ranges::transform(parts, parts.begin(), without_blanks);
    const std::string_view ends = parts.front();
    parts.erase(parts.begin());
    const auto spacing =
        std::ranges::find_if(parts, [](std::string_view part) { return part == "lin" || part == "log"; });
    if (spacing != parts.end()) {  // before or after the count
        axis_.spacing = *spacing == "log" ? Spacing::logarithmic : Spacing::linear;
        parts.erase(spacing);
    }
    if (parts.size() != (sampling_ == Sampling::grid ? 1U : 0U)) {
        refuse(text, form_of(axis_.key.name, sampling_));
        return;
    }
    if (axis_.key.kind == ValueKind::word) {
        refuse(text, "a list of words: A,B,C");
        return;
    }
    const std::size_t dots = ends.find("..");
    const std::string_view low = without_blanks(ends.substr(0, dots));
    const std::string_view high = without_blanks(ends.substr(dots + 2));
    refuse_without_unit(std::array{low, high});
    const auto from = value(low);
    const auto to = value(high);
    if (sampling_ == Sampling::grid) {
        read_count(parts.front());
    }
    if (!from || !to || !faults.empty()) {
        return;
    }
    axis_.from = number_of(*from);
    axis_.to = number_of(*to);
    if (!(axis_.from < axis_.to)) {
        refuse(ends, "a range that goes up: FROM below TO");
    } else if (axis_.spacing == Spacing::logarithmic && !(axis_.from > 0)) {
        refuse(ends, "a range above 0, as it is logarithmic");
    } else {
        refuse_repeated_integers();
    }
}

std::optional<Axis> AxisReader::read(std::string_view option) {
    const std::size_t equals = option.find('=');
    if (equals == std::string_view::npos) {
        refuse(option, form_of("KEY", sampling_));
        return std::nullopt;
    }
    if (!find_key(without_blanks(option.substr(0, equals)))) {
        return std::nullopt;
    }
    return read(std::move(axis_.key), option.substr(equals + 1));
}

std::optional<Axis> AxisReader::read(SceneKey key, std::string_view text) {
    axis_.key = std::move(key);
    text = without_blanks(text);
    if (!axis_.key.traits.is_text && text.find("..") != std::string_view::npos) {  // a path may have dots
        read_range(text);
    } else if (axis_.key.kind != ValueKind::word && text.find(':') != std::string_view::npos) {
        refuse(text, form_of(axis_.key.name, sampling_));  // a count without a range
    } else {
        read_list(text);
    }
    return faults.empty() ? std::optional(std::move(axis_)) : std::nullopt;
}

std::optional<Axis> AxisReader::read(std::string_view key, std::span<const SceneValue> values) {
    if (!find_key(key)) {
        return std::nullopt;
    }
    axis_.list.reserve(values.size());
    for (const SceneValue& value : values) {
        add_to_list(allowed_value(scene_, axis_.key, value));
        if (faults.size() == max_faults) {
            break;
        }
    }
    return faults.empty() ? std::optional(std::move(axis_)) : std::nullopt;
}

tl::expected<Axis, std::vector<Fault>> axis_or_faults(std::optional<Axis> axis, AxisReader& reader) {
    return axis ? tl::expected<Axis, std::vector<Fault>>(*std::move(axis))
                : tl::unexpected(std::move(reader.faults));
}

}  // namespace

tl::expected<SceneKey, Fault> varied_key(const Scene& scene, std::string_view name) {
    auto key = scene_key_named(scene, name);
    if (key && key->is_list()) {
        return tl::unexpected(Fault{key->name, "a list", "an entry of it, as " + key->entry(0).name});
    }
    if (key && key->name == "drive.file" && !scene.drive.samples.empty()) {
        return tl::unexpected(Fault{key->name, "a key that varies beside a record that the scene has",
                                    "a scene without drive.file"});
    }
    if (key && key->traits.reads_record && !scene.drive.samples.empty()) {
        return tl::unexpected(
            Fault{key->name, "a key by which the record was read, once for all points",
                  "such a key beside --vary drive.file=FILE: each point then reads the record"});
    }
    return key;
}

SceneValue Axis::value(std::int64_t number) const {
    if (!list.empty()) {
        return list[static_cast<std::size_t>(number)];
    }
    if (number == 0 || number == count - 1) {
        return value_of(key, number == 0 ? from : to);
    }
    const double share = static_cast<double>(number) / static_cast<double>(count - 1);
    return value_of(
        key, spacing == Spacing::linear ? from + (to - from) * share : from * std::pow(to / from, share));
}

std::size_t Axis::element_at(double position) const noexcept {
    const auto size = static_cast<double>(list.size());
    return static_cast<std::size_t>(std::min(position * size, size - 1));
}

SceneValue Axis::at(double position) const {
    if (!list.empty()) {
        return list[element_at(position)];
    }
    // the ends have the same share as other integers, because numbers within 0.5 are rounded to them
    const double margin = key.kind == ValueKind::integer ? 0.5 : 0;
    const double low = from - margin;
    const double high = to + margin;
    const double number =
        spacing == Spacing::linear ? low + (high - low) * position : low * std::pow(high / low, position);
    return value_of(key, std::clamp(number, from, to));
}

double Axis::position(const SceneValue& value) const {
    const double number = number_of(value);
    return spacing == Spacing::linear ? (number - from) / (to - from)
                                      : std::log(number / from) / std::log(to / from);
}

std::string Axis::text() const {
    std::string result = key.name + '=';
    if (!list.empty()) {
        for (const SceneValue& one : list) {
            const auto* word = std::get_if<std::string>(&one);  // quoted: a word can look like a number
            result += (result.back() == '=' ? "" : ",") +
                      (word != nullptr ? hertzline::quoted(*word) : value_text(one));
        }
        return result;
    }
    result += value_text(value_of(key, from)) + ".." + value_text(value_of(key, to)) +
              (spacing == Spacing::linear ? ":lin" : ":log");
    return count > 0 ? result + ':' + number_text(count) : result;
}

tl::expected<Axis, std::vector<Fault>> parse_axis(const Scene& scene, std::string_view option,
                                                  Sampling sampling) {
    AxisReader reader(scene, sampling);
    auto axis = reader.read(option);
    for (Fault& fault : reader.faults) {
        fault.place = {"--vary " + printable(option), 0};
    }
    return axis_or_faults(std::move(axis), reader);
}

std::string setting_of(std::string_view key, std::string_view value) {
    value = without_blanks(value);
    return fmt::format("{}={}{}", without_blanks(key),
                       value.starts_with('.') && !value.starts_with("..") ? "0" : "", value);
}

std::string first_setting(std::string_view option) {
    const std::size_t equals = std::min(option.find('='), option.size());
    const std::string_view values = option.substr(std::min(equals + 1, option.size()));
    const bool is_path = values.find('/') != std::string_view::npos;  // which may have dots
    const std::string_view first =
        values.substr(0, std::min(values.find(','), is_path ? values.size() : values.find("..")));
    return setting_of(option.substr(0, equals), first);
}

tl::expected<Axis, std::vector<Fault>> parse_values(const Scene& scene, SceneKey key, std::string_view text,
                                                    Sampling sampling) {
    AxisReader reader(scene, sampling);
    auto axis = reader.read(std::move(key), text);
    return axis_or_faults(std::move(axis), reader);
}

tl::expected<Axis, std::vector<Fault>> axis_of(const Scene& scene, std::string_view key,
                                               std::span<const SceneValue> values) {
    AxisReader reader(scene, Sampling::grid);
    auto axis = reader.read(key, values);
    return axis_or_faults(std::move(axis), reader);
}

double unit_fraction(std::uint64_t number) noexcept {
    constexpr int mantissa = 53;
    return std::ldexp(static_cast<double>(number >> (64 - mantissa)), -mantissa);
}

}  // namespace hertzline::studies
