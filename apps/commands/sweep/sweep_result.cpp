#include "apps/commands/sweep/sweep_result.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <optional>
#include <set>

#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"
#include <fmt/format.h>

#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

void print_rows(const studies::Sweep& sweep, const recordings::Table& table) {
    constexpr std::size_t enough = std::size_t{1} << 16;
    std::string text;
    recordings::TableRow row;
    for (std::int64_t point = 0; point < table.rows; ++point) {
        table.read(point, row);
        text += json_text(studies::row_json(sweep, row)) + '\n';
        if (text.size() > enough) {
            print(text);
            text.clear();
        }
    }
    print(text);
}

}  // namespace

void check_output(const SweepOptions& options, Faults& faults) {
    if (options.files.empty() && options.format == Format::text) {
        faults.add("-o FILE is missing: give a file that ends in .h5 or .csv, or --json");
    }
}

void check_tables(std::span<const std::string> files, std::optional<Tap> waveform, Faults& faults) {
    recordings::Table table;
    table.columns.push_back({{"status", "", ""}, recordings::CellKind::text});
    if (waveform) {
        table.samples.emplace();
    }
    std::set<std::filesystem::path> names;
    for (const std::string& file : files) {
        if (const auto fault = recordings::table_fault(file, table)) {
            faults.add(*fault + (waveform ? ", which holds waveforms" : ""));
        } else if (!names.insert(recordings::recording_name(file)).second) {
            faults.add(printable(file), "found a second time, allowed: each file once");
        }
    }
}

double table_bytes(std::span<const std::string> files, const studies::Sweep& sweep) {
    const std::vector<recordings::TableColumn> columns = studies::columns_of(sweep);
    return std::accumulate(files.begin(), files.end(), 0.0, [&](double bytes, const std::string& file) {
        return bytes + recordings::table_bytes(file, columns, static_cast<double>(sweep.plan.size()),
                                               sweep.samples());
    });
}

bool write_tables(std::span<const std::string> files, const recordings::Table& table) {
    return std::ranges::all_of(
        files, [&](const std::string& file) { return recordings::write_table(file, table, stop_asked()); });
}

bool write_result(const SweepOptions& options, const studies::Sweep& sweep, const recordings::Table& table) {
    if (!write_tables(options.files, table)) {
        return false;
    }
    if (options.format == Format::json) {
        print_rows(sweep, table);
    }
    return true;
}

Json names_json(const std::vector<std::string>& files) {
    return files.size() == 1 ? Json(files.front()) : Json(files);
}

void print_counts(const SweepOptions& options, const studies::PointCounts& counts,
                  const std::vector<std::string>& files) {
    if (options.format == Format::json) {
        return;
    }
    Json summary{{"points", counts.all()}};
    for (std::size_t i = 0; i < counts.of_status.size(); ++i) {
        summary[std::string(studies::point_status_words[i])] = counts.of_status[i];
    }
    summary["file"] = names_json(files);
    print_summary(summary, Format::text);
}

}  // namespace hertzline::app
