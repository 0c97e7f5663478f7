#include "stream/recordings/checked_writer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/text.hpp"

namespace hertzline::stream {
namespace {

using Json = nlohmann::ordered_json;

constexpr int max_depth = 32;

/// Names become field names, links and keys: nothing that any of these formats would have to escape.
bool usable_name(std::string_view name) {
    constexpr std::string_view others = "_-";
    return !name.empty() && std::ranges::all_of(name, [&](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               others.find(c) != std::string_view::npos;
    });
}

/// What is wrong with the head; empty when nothing is.
std::string fault_of(const RecordingHead& head) {
    if (head.columns.empty()) {
        return "no columns";
    }
    if (!(head.sample_rate_hz > 0) || !std::isfinite(head.sample_rate_hz)) {
        return fmt::format("sample rate: found {} Hz, allowed: more than 0", head.sample_rate_hz);
    }
    std::set<std::string_view> names{"t_s"};
    for (const Column& column : head.columns) {
        if (!usable_name(column.name) || !usable_name(column.quantity)) {
            return fmt::format("column \"{}\" of \"{}\": allowed in names: letters, digits, _ and -",
                               column.name, column.quantity);
        }
        if (!names.insert(column.name).second) {
            return fmt::format("column \"{}\": found twice, or the time's name", column.name);
        }
    }
    return {};
}

}  // namespace

CheckedWriter::CheckedWriter(std::filesystem::path path, RecordingHead head)
    : path_(std::move(path)), head_(std::move(head)) {
    if (const std::string fault = fault_of(head_); !fault.empty()) {
        throw std::invalid_argument(path_.string() + ": " + fault);
    }
}

void CheckedWriter::write(std::int64_t first, std::span<const double> values) {
    if (values.size() % head_.columns.size() != 0 || first < due_) {
        throw std::invalid_argument(fmt::format("{}: {} values from sample {} where {} a row from {} are due",
                                                path_.string(), values.size(), first, head_.columns.size(),
                                                due_));
    }
    if (!failure_.empty()) {
        throw std::runtime_error(failure_);
    }
    if (values.empty()) {
        return;
    }
    try {
        take(first, values);
    } catch (const std::exception& error) {
        failure_ = error.what();
        throw;
    }
}

void CheckedWriter::take(std::int64_t first, std::span<const double> values) {
    require_finite(first, values);
    if (rows_ == 0 || first != due_) {
        begin_capture({rows_, first});
    }
    append(first, values);
    const auto rows = static_cast<std::int64_t>(values.size() / head_.columns.size());
    rows_ += rows;
    due_ = first + rows;
}

void CheckedWriter::require_finite(std::int64_t first, std::span<const double> values) const {
    const bool narrow = head_.numbers == NumberType::float32;
    const double largest = narrow ? std::numeric_limits<float>::max() : std::numeric_limits<double>::max();
    const auto bad = std::ranges::find_if_not(values, [&](double v) { return std::abs(v) <= largest; });
    if (bad != values.end()) {
        const auto at = static_cast<std::size_t>(bad - values.begin());
        const std::size_t columns = head_.columns.size();
        cannot_write(path_, fmt::format("{} of sample {} is {}, which {} cannot hold",
                                        head_.columns[at % columns].name,
                                        first + static_cast<std::int64_t>(at / columns), *bad,
                                        narrow ? "float32" : "a recording"));
    }
}

void CheckedWriter::commit() {
    if (!failure_.empty()) {
        throw std::runtime_error(failure_);
    }
    try {
        finish();
    } catch (const std::exception& error) {
        failure_ = error.what();
        throw;
    }
}

void cannot_write(const std::filesystem::path& path, std::string_view reason) {
    throw std::runtime_error(fmt::format("cannot write {}: {}", path.string(), reason));
}

void cannot_read(const std::filesystem::path& path, std::string_view reason) {
    constexpr std::size_t longest = 300;  // it may quote the file
    throw std::runtime_error(fmt::format("cannot read {}: {}", path.string(), printable(reason, longest)));
}

void require_undamaged(const std::filesystem::path& path, std::int64_t row, std::span<const double> values,
                       std::size_t columns) {
    const auto bad = std::ranges::find_if_not(values, [](double v) { return std::isfinite(v); });
    if (bad != values.end()) {
        const auto at = static_cast<std::size_t>(bad - values.begin());
        cannot_read(path, fmt::format("damaged: row {}, column {} is {}, which no sample is",
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

RecordingHead head_of(Json description, NumberType numbers) {
    RecordingHead head;
    head.numbers = numbers;
    try {
        description.at("sample_rate_hz").get_to(head.sample_rate_hz);
        for (const Json& column : description.at("columns")) {
            head.columns.push_back({column.at(0), column.at(1), printable(std::string(column.at(2)))});
        }
        head.provenance = std::move(description.at("provenance"));
    } catch (const Json::exception&) {
        throw std::runtime_error("description: expected sample_rate_hz, columns and provenance");
    }
    if (const std::string fault = fault_of(head); !fault.empty()) {
        throw std::runtime_error("description: " + fault);
    }
    return head;
}

std::string text_of(const Json& json) {
    return json.dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
}

Json json_from_outside(std::string_view text) {
    bool deep = false;
    const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
        deep = deep || depth > max_depth;
        return !deep;
    };
    Json json = Json::parse(text, shallow, /*allow_exceptions=*/false);
    if (deep || json.is_discarded()) {
        throw std::runtime_error(deep ? "description: nested too deep" : "description: no JSON");
    }
    return json;
}

RecordingHead head_of_channels(std::size_t channels, double sample_rate_hz, NumberType numbers) {
    RecordingHead head{{}, sample_rate_hz, numbers, {}};
    for (std::size_t i = 1; i <= channels; ++i) {
        const std::string name = "channel_" + std::to_string(i);
        head.columns.push_back({name, name, ""});
    }
    return head;
}

}  // namespace hertzline::stream
