#include "apps/commands/sweep/sweep_result.hpp"

#include <cstddef>
#include <cstdint>

#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "stream/files/errors.hpp"
#include "stream/sweep/sweep_files.hpp"

namespace hertzline::app {

namespace {

void print_rows(const stream::SweepTable& table) {
    constexpr std::size_t enough = std::size_t{1} << 16;
    std::string text;
    for (std::int64_t point = 0; point < table.sweep().plan.size(); ++point) {
        text += json_text(stream::row_json(table, point)) + '\n';
        if (text.size() > enough) {
            print(text);
            text.clear();
        }
    }
    print(text);
}

}  // namespace

void refuse_no_output(const SweepOptions& options) {
    if (options.output.empty() && options.format == Format::text) {
        throw WrongUse("-o: found no file, allowed: a file that ends in .h5 or .csv, or --json");
    }
}

void require_rows_of(const stream::Sweep& sweep, const stream::Journal& journal) {
    if (journal.payload_bytes() != stream::payload_bytes(sweep.demand)) {
        stream::cannot_read(journal.path(), "its rows are not those of its sweep");
    }
}

bool write_result(const SweepOptions& options, const stream::SweepTable& table) {
    if (!options.output.empty() && !stream::write_sweep(options.output, table, stop_asked())) {
        return false;
    }
    if (options.format == Format::json) {
        print_rows(table);
    }
    return true;
}

void print_counts(const SweepOptions& options, const stream::PointCounts& counts, const std::string& file) {
    if (options.format == Format::json) {
        return;
    }
    Json summary{{"points", counts.all()}};
    for (std::size_t i = 0; i < counts.of_status.size(); ++i) {
        summary[std::string(stream::point_status_words[i])] = counts.of_status[i];
    }
    summary["file"] = file;
    print_summary(summary, Format::text);
}

}  // namespace hertzline::app
