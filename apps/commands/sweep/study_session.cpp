#include "apps/commands/sweep/study_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/commands/sweep/shard_argument.hpp"
#include "apps/console/messages.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "measures/resources.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

using studies::Journal;
using studies::Study;

constexpr auto between_messages = std::chrono::seconds(10);
constexpr std::string_view how_to_continue = "the same command with --resume continues";

/// A hint for a journal that was written on another instruction set.
std::string target_advice(const std::string& journal) {
    const Json json = json_from_outside(journal);
    const Json target = json.is_object() ? json.value("simd_target", Json()) : Json();
    return !target.is_string() || target == kernels::kernel_target()
               ? std::string()
               : fmt::format("; --target {} continues it, where the processor has it",
                             printable(target.get<std::string>()));
}

/// Returns whether a study has begun its journal; one that was killed earlier leaves an empty file.
bool has_begun(const std::string& journal) {
    try {
        return fs::is_regular_file(journal) && !Journal(journal, Journal::Use::read).is_new();
    } catch (const std::runtime_error&) {
        return false;
    }
}

void print_rows(const studies::Study& study, const recordings::Table& table) {
    constexpr std::size_t enough = std::size_t{1} << 16;
    std::string text;
    recordings::TableRow row;
    for (std::int64_t point = 0; point < table.rows; ++point) {
        table.read(point, row);
        text += json_text(studies::row_json(study, row)) + '\n';
        if (text.size() > enough) {
            print(text);
            text.clear();
        }
    }
    print(text);
}

}  // namespace

std::optional<recordings::WrittenTable> finished_table(const SweepOptions& options, const Study& study,
                                                       std::initializer_list<std::string_view> but) {
    const bool whole = options.resume && !options.files.empty() && study.shard.parts == 1;
    const auto is_there = [](const std::string& file) { return fs::is_regular_file(file); };
    if (!whole || has_begun(journal_name(options.files.front(), study.shard)) ||
        std::ranges::none_of(options.files, is_there)) {
        return std::nullopt;
    }
    const std::string_view kind = study.is_search() ? "search" : "sweep";
    std::optional<recordings::WrittenTable> first;
    for (const std::string& file : options.files) {
        if (!is_there(file)) {
            continue;
        }
        recordings::WrittenTable written = recordings::read_table(file, studies::records_name);
        if (const auto difference = studies::table_difference(written, study, but)) {
            throw WrongUse(
                fmt::format("{}: found {}, allowed: the table of the same {}, made by the same program; "
                            "without --resume it is replaced",
                            printable(file), *difference, kind));
        }
        first = first ? std::move(first) : std::optional(std::move(written));
    }
    if (const auto missing = std::ranges::find_if_not(options.files, is_there);
        missing != options.files.end()) {
        throw WrongUse(fmt::format(
            "{}: found no file, beside another one with this {}, allowed: -o with the tables that are there; "
            "without --resume the {} is made anew",
            printable(*missing), kind, kind));
    }
    return first;
}

Journal open_journal(const SweepOptions& options, const studies::Shard& shard) {
    if (options.files.empty()) {
        return Journal::in_memory();
    }
    return {journal_name(options.files.front(), shard),
            options.resume ? Journal::Use::resume : Journal::Use::begin};
}

void begin_or_compare(Journal& journal, const Study& study, bool resume) {
    const std::string_view kind = study.is_search() ? "search" : "sweep";
    if (journal.is_new()) {
        if (resume) {
            spdlog::info("{} does not exist; the {} starts with its first point",
                         printable_whole(journal.path().string()), kind);
        }
        journal.begin(studies::journal_text(study), studies::columns_of(study));
    } else if (const auto difference = studies::journal_difference(journal.text(), study)) {
        throw WrongUse(fmt::format(
            "{}: found {}, allowed: the journal of the same {}, made by the same program{}",
            printable_whole(journal.path().string()), *difference, kind, target_advice(journal.text())));
    }
}

void refuse_memory_shortage(std::string_view study, int jobs, double bytes) {
    if (const auto shortage = measures::memory_shortage(
            fmt::format("{} with {} job{}", study, jobs, jobs == 1 ? "" : "s"), bytes)) {
        throw std::runtime_error(*shortage + "; fewer --jobs take less");
    }
}

void refuse_shortages(const SweepOptions& options, std::string_view study, int jobs,
                      const StudyNeeds& needs) {
    refuse_memory_shortage(study, jobs, needs.memory_bytes);
    if (options.files.empty()) {
        return;
    }
    throw_if(measures::disk_shortage(options.files.front(), needs.disk_bytes));
}

void run_to_journal(Journal& journal, const std::function<void()>& work) {
    try {
        work();
        journal.commit();
    } catch (const std::exception& error) {
        const std::string reason = error.what();
        try {
            journal.commit();
        } catch (const std::exception&) {  // the first error is reported
        }
        if (!journal.has_rows() || journal.is_in_memory()) {
            throw;
        }
        throw std::runtime_error(fmt::format("{}; the finished points are in {}: {}", reason,
                                             printable_whole(journal.path().string()), how_to_continue));
    }
}

Exit stopped(const Journal& journal, std::string_view done) {
    if (!journal.has_rows() || journal.is_in_memory()) {
        spdlog::error("stopped after {}; nothing was saved", done);
    } else {
        spdlog::error("stopped after {}, which are in {}: {}", done, printable_whole(journal.path().string()),
                      how_to_continue);
    }
    return Exit::failed;
}

std::string progress_text(const studies::PointCounts& done, std::int64_t all, double elapsed_s) {
    const auto points = static_cast<double>(done.all());
    const double rate = elapsed_s > 0 ? points / elapsed_s : 0;
    const double left = rate > 0 ? (static_cast<double>(all) - points) / rate : INFINITY;
    const std::string faults = done.faults();
    return fmt::format("{:3.0f} %  {} of {} points, {:.3g} points/s, {} left{}{}",
                       all > 0 ? 100 * points / static_cast<double>(all) : 100, done.all(), all, rate,
                       time_text(left), faults.empty() ? "" : "; ", faults);
}

StudyProgress::StudyProgress(std::int64_t all) : all_(all), terminal_(stderr_is_terminal()) {}

double StudyProgress::elapsed_s() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
}

void StudyProgress::show(const studies::PointCounts& done) {
    if (line_.due()) {
        line_.show(progress_text(done, all_, elapsed_s()));
    }
    if (!terminal_ && Clock::now() - last_message_ >= between_messages) {
        spdlog::info(progress_text(done, all_, elapsed_s()));
        last_message_ = Clock::now();
    }
}

double table_bytes(std::span<const std::string> files, const studies::Study& study) {
    const std::vector<recordings::TableColumn> columns = studies::columns_of(study);
    return std::accumulate(files.begin(), files.end(), 0.0, [&](double bytes, const std::string& file) {
        return bytes + recordings::table_bytes(file, columns, static_cast<double>(study.plan.size()),
                                               study.samples());
    });
}

bool write_tables(std::span<const std::string> files, const recordings::Table& table) {
    return std::ranges::all_of(
        files, [&](const std::string& file) { return recordings::write_table(file, table, stop_asked()); });
}

bool write_result(const SweepOptions& options, const studies::Study& study, const recordings::Table& table) {
    if (!write_tables(options.files, table)) {
        return false;
    }
    if (options.format == Format::json) {
        print_rows(study, table);
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
