#include "apps/commands/sweep/sweep_result.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <optional>
#include <set>

#include "recordings/files/errors.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/sweep/sweep_files.hpp"
#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

void print_rows(const studies::SweepTable& table) {
    constexpr std::size_t enough = std::size_t{1} << 16;
    std::string text;
    for (std::int64_t point = 0; point < table.sweep().plan.size(); ++point) {
        text += json_text(studies::row_json(table, point)) + '\n';
        if (text.size() > enough) {
            print(text);
            text.clear();
        }
    }
    print(text);
}

}  // namespace

void refuse_no_output(const SweepOptions& options) {
    if (options.files.empty() && options.format == Format::text) {
        throw WrongUse("-o: found no file, allowed: a file that ends in .h5 or .csv, or --json");
    }
}

void refuse_wrong_tables(std::span<const std::string> files, bool with_waveforms) {
    Faults faults;
    std::set<std::filesystem::path> names;
    for (const std::string& file : files) {
        faults.of([&] {
            if (const auto fault = studies::sweep_file_fault(file, with_waveforms)) {
                throw WrongUse(*fault);
            }
            if (!names.insert(recordings::recording_name(file)).second) {
                throw WrongUse(
                    fmt::format("{}: found a second time, allowed: each file once", printable(file)));
            }
        });
    }
    faults.refuse();
}

void require_rows_of(const studies::Sweep& sweep, const studies::Journal& journal) {
    if (journal.payload_bytes() != studies::payload_bytes(sweep.demand)) {
        recordings::cannot_read(journal.path(), "its rows are not those of its sweep");
    }
}

double table_bytes(std::span<const std::string> files, const studies::Sweep& sweep) {
    return std::accumulate(files.begin(), files.end(), 0.0, [&](double bytes, const std::string& file) {
        return bytes + studies::sweep_file_bytes(file, sweep);
    });
}

bool write_tables(std::span<const std::string> files, const studies::SweepTable& table) {
    return std::ranges::all_of(
        files, [&](const std::string& file) { return studies::write_sweep(file, table, stop_asked()); });
}

bool write_result(const SweepOptions& options, const studies::SweepTable& table) {
    if (!write_tables(options.files, table)) {
        return false;
    }
    if (options.format == Format::json) {
        print_rows(table);
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
