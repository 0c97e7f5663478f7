#include "apps/commands/sweep/study_session.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "measures/resources.hpp"
#include "studies/sweep/sweep_table.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/commands/sweep/shard_argument.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

using studies::Journal;
using studies::Sweep;

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

/// Whether a study has begun its journal: one that was killed before leaves an empty file.
bool has_begun(const std::string& journal) {
    try {
        return fs::is_regular_file(journal) && !Journal(journal, Journal::Use::read).is_new();
    } catch (const std::runtime_error&) {
        return false;
    }
}

}  // namespace

std::optional<recordings::WrittenTable> finished_table(const SweepOptions& options, const Sweep& sweep,
                                                       std::initializer_list<std::string_view> but) {
    const bool whole = options.resume && !options.files.empty() && sweep.shard.parts == 1;
    const auto is_there = [](const std::string& file) { return fs::is_regular_file(file); };
    if (!whole || has_begun(journal_name(options.files.front(), sweep.shard)) ||
        !std::ranges::all_of(options.files, is_there)) {
        return std::nullopt;
    }
    std::optional<recordings::WrittenTable> first;
    for (const std::string& file : options.files) {
        recordings::WrittenTable written = recordings::read_table(file, studies::records_name);
        if (const auto difference = studies::table_difference(written, sweep, but)) {
            throw WrongUse(
                fmt::format("{}: found {}, allowed: the table of the same {}, made by the same program; "
                            "without --resume it is replaced",
                            printable(file), *difference, sweep.is_search() ? "search" : "sweep"));
        }
        first = first ? std::move(first) : std::optional(std::move(written));
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

void begin_or_compare(Journal& journal, const Sweep& sweep, bool resume) {
    const std::string_view study = sweep.is_search() ? "search" : "sweep";
    if (journal.is_new()) {
        if (resume) {
            spdlog::info("{} is not there; the {} begins with its first point", journal.path().string(),
                         study);
        }
        journal.begin(studies::journal_text(sweep), studies::columns_of(sweep));
    } else if (const auto difference = studies::journal_difference(journal.text(), sweep)) {
        throw WrongUse(
            fmt::format("{}: found {}, allowed: the journal of the same {}, made by the same program{}",
                        journal.path().string(), *difference, study, target_advice(journal.text())));
    }
}

void refuse_shortages(const SweepOptions& options, std::string_view study, int jobs,
                      const StudyNeeds& needs) {
    if (const auto shortage =
            measures::memory_shortage(fmt::format("{} with {} jobs", study, jobs), needs.memory_bytes)) {
        throw std::runtime_error(*shortage + "; fewer --jobs take less");
    }
    if (options.files.empty()) {
        return;
    }
    if (const auto shortage = measures::disk_shortage(options.files.front(), needs.disk_bytes)) {
        throw std::runtime_error(*shortage);
    }
}

void run_to_journal(Journal& journal, const std::function<void()>& work) {
    try {
        work();
        journal.commit();
    } catch (const std::exception& error) {
        const std::string reason = error.what();
        try {
            journal.commit();
        } catch (const std::exception&) {  // the first error counts
        }
        if (!journal.has_rows() || journal.is_in_memory()) {
            throw;
        }
        throw std::runtime_error(fmt::format("{}; the points that are done are in {}: {}", reason,
                                             journal.path().string(), how_to_continue));
    }
}

Exit stopped(const Journal& journal, std::string_view done) {
    if (!journal.has_rows() || journal.is_in_memory()) {
        spdlog::error("stopped after {}; nothing was saved", done);
    } else {
        spdlog::error("stopped after {}, which are in {}: {}", done, journal.path().string(),
                      how_to_continue);
    }
    return Exit::failed;
}

}  // namespace hertzline::app
