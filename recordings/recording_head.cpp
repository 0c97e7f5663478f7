#include "recordings/recording_head.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "hertzline/taps.hpp"
#include "recordings/files/input_file.hpp"

namespace hertzline::recordings {

std::optional<std::string> head_fault(const RecordingHead& head) {
    if (head.columns.empty()) {
        return "no columns";
    }
    if (!(head.sample_rate_hz > 0) || !std::isfinite(head.sample_rate_hz)) {
        return fmt::format("sample rate: found {} Hz, allowed: more than 0", head.sample_rate_hz);
    }
    std::set<std::string_view> names{"t_s"};
    for (const Column& column : head.columns) {
        // names become field names, links and keys: nothing that any format would have to escape
        if (!is_bare_key(column.name) || !is_bare_key(column.quantity)) {
            return fmt::format(R"(column "{}" of "{}": allowed in names: letters, digits, _ and -)",
                               column.name, column.quantity);
        }
        if (!names.insert(column.name).second) {
            return fmt::format("column \"{}\": found twice, or named like the time", column.name);
        }
    }
    return std::nullopt;
}

std::optional<std::string> table_in_place_of_recording(std::string_view first_column) {
    const auto fault = [](std::string_view found) {
        return fmt::format("found {}, allowed: a recording, which has samples over time", found);
    };
    return first_column == "point"          ? std::optional(fault("a table of a sweep, a search or a field"))
           : first_column == "frequency_hz" ? std::optional(fault("a spectrum"))
                                            : std::nullopt;
}

void require_undamaged(const std::filesystem::path& path, std::int64_t row, std::span<const double> values,
                       std::size_t columns) {
    const auto bad = std::ranges::find_if_not(values, [](double v) { return std::isfinite(v); });
    if (bad != values.end()) {
        const auto at = static_cast<std::size_t>(bad - values.begin());
        cannot_read(path, fmt::format("damaged: row {}, column {} is {}, allowed: finite numbers",
                                      row + static_cast<std::int64_t>(at / columns), at % columns + 1, *bad));
    }
}

Json describe(const RecordingHead& head) {
    Json columns = Json::array();
    for (const Column& column : head.columns) {
        columns.push_back({column.name, column.quantity, column.unit});
    }
    return {{"sample_rate_hz", head.sample_rate_hz},
            {"columns", std::move(columns)},
            {"provenance", head.provenance}};
}

Json describe_without_changes(const RecordingHead& head) {
    Json description = describe(head);
    if (Json& provenance = description["provenance"]; provenance.is_object()) {
        provenance.erase("changes");
    }
    return description;
}

RecordingHead head_of(Json description, NumberType numbers) {
    RecordingHead head;
    head.numbers = numbers;
    try {
        description.at("sample_rate_hz").get_to(head.sample_rate_hz);
        for (const Json& column : description.at("columns")) {
            head.columns.push_back({column.at(0), column.at(1), column_text(std::string(column.at(2)))});
        }
        head.provenance = std::move(description.at("provenance"));
    } catch (const Json::exception&) {
        throw std::runtime_error("description: expected sample_rate_hz, columns and provenance");
    }
    if (const auto fault = head_fault(head)) {
        throw std::runtime_error("description: " + *fault);
    }
    return head;
}

void name_apart(std::vector<Column>& columns) {
    std::set<std::string> names{"t_s"};
    std::map<std::string, int> uses;  // of a name
    for (std::size_t i = 0; i < columns.size(); ++i) {
        Column& column = columns[i];
        if (column.name.empty()) {
            column.name = column.quantity = fmt::format("channel_{}", i + 1);
        }
        const std::string name = column.name;
        while (!names.insert(column.name).second) {
            column.name = fmt::format("{}_{}", name, uses[name]++ + 2);
        }
        if (column.quantity == name && !tap_named(name)) {
            column.quantity = column.name;  // two of one name are two quantities
        }
    }
}

RecordingHead head_of_channels(std::size_t channels, double sample_rate_hz, NumberType numbers) {
    RecordingHead head{{}, sample_rate_hz, numbers, {}};
    for (std::size_t i = 1; i <= channels; ++i) {
        const std::string name = "channel_" + std::to_string(i);
        head.columns.push_back({name, name, ""});
    }
    return head;
}

CaptureCursor::CaptureCursor(std::vector<Capture> captures, std::int64_t rows)
    : captures_(std::move(captures)), rows_(rows) {
    if (captures_.empty()) {
        throw std::runtime_error("damaged: no captures");
    }
    for (std::size_t i = 0; i < captures_.size(); ++i) {
        if (!follows(captures_[i], i == 0 ? nullptr : &captures_[i - 1])) {
            throw std::runtime_error(fmt::format("damaged: capture {} begins at row {} of {} with sample {}",
                                                 i + 1, captures_[i].row, rows_, captures_[i].sample));
        }
    }
}

bool CaptureCursor::follows(const Capture& now, const Capture* before) const noexcept {
    constexpr std::int64_t max_sample = std::int64_t{1} << 62;
    if (now.row < 0 || now.sample < 0 || now.sample > max_sample) {
        return false;
    }
    return before == nullptr ? now.row == 0
                             : now.row > before->row && now.row < rows_ &&
                                   now.sample - now.row > before->sample - before->row;
}

std::int64_t CaptureCursor::sample() const noexcept {
    return captures_[current_].sample + (row_ - captures_[current_].row);
}

std::int64_t CaptureCursor::left() const noexcept {
    return (current_ + 1 < captures_.size() ? captures_[current_ + 1].row : rows_) - row_;
}

void CaptureCursor::advance(std::int64_t rows) noexcept {
    assert(rows <= left());
    row_ += rows;
    if (left() == 0 && current_ + 1 < captures_.size()) {
        ++current_;
    }
}

}  // namespace hertzline::recordings
