#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "measures/resources.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/sweep/journal.hpp"
#include "studies/sweep/workers.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/commands/sweep/shard_argument.hpp"
#include "apps/commands/sweep/sweep_merge.hpp"
#include "apps/commands/sweep/sweep_options.hpp"
#include "apps/commands/sweep/sweep_progress.hpp"
#include "apps/commands/sweep/sweep_result.hpp"
#include "apps/commands/sweep/unused_journal.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

using studies::Journal;
using studies::PointCounts;
using studies::PointStatus;
using studies::Sweep;

Journal open_journal(const SweepOptions& options, const Sweep& sweep) {
    if (options.files.empty()) {
        return Journal::passing();
    }
    return {journal_name(options.files.front(), sweep.shard),
            options.resume ? Journal::Use::resume : Journal::Use::begin};
}

/// What helps where a journal's rows were made with other instructions.
std::string target_advice(const std::string& journal) {
    std::string target;
    try {
        target = studies::maker_of_journal(journal).at("simd_target").get<std::string>();
    } catch (const std::runtime_error&) {
        return {};  // of another format
    }
    return target == kernels::kernel_target()
               ? std::string()
               : fmt::format("; --target {} goes on with it, where the processor has it", printable(target));
}

/// Gives it its beginning, or finds out that it has the right one.
void prepare(Journal& journal, const Sweep& sweep, bool resume) {
    const std::string text = studies::journal_text(sweep);
    if (journal.is_new()) {
        if (resume) {
            spdlog::info("{} is not there; the sweep begins with its first point", journal.path().string());
        }
        journal.begin(text, studies::payload_bytes(sweep.demand));
    } else if (const auto difference = studies::journal_difference(journal.text(), text)) {
        throw WrongUse(
            fmt::format("{}: found {}, allowed: the journal of the same sweep, made by the same program{}",
                        journal.path().string(), *difference, target_advice(journal.text())));
    }
    require_rows_of(sweep, journal);
    journal.load(sweep.plan.size());
    if (journal.damaged() > 0) {
        spdlog::warn("{}: {} damaged rows are computed again", journal.path().string(), journal.damaged());
    }
}

/// The points of this part that have no row yet, or one that is tried again; the others are counted.
std::vector<std::int64_t> missing_points(const Sweep& sweep, const Journal& journal, PointCounts& there) {
    std::vector<std::int64_t> missing;
    for (std::int64_t point = sweep.shard.part - 1; point < sweep.plan.size(); point += sweep.shard.parts) {
        if (!journal.has(point) || journal.status(point) == PointStatus::failed) {
            missing.push_back(point);
        } else {
            ++there[journal.status(point)];
        }
    }
    return missing;
}

void refuse_shortages(const SweepOptions& options, const SoundSweep& sound, std::size_t missing,
                      int threads) {
    const Sweep& sweep = sound.sweep;
    const double points_bytes = 16 * static_cast<double>(sweep.plan.size());  // the journal's index
    const double memory = threads * sound.survey.memory_bytes + points_bytes;
    if (const auto shortage =
            measures::memory_shortage(fmt::format("a sweep with {} jobs", threads), memory)) {
        throw std::runtime_error(*shortage + "; fewer --jobs take less");
    }
    const double journal = Journal::bytes(static_cast<double>(missing), studies::payload_bytes(sweep.demand));
    const double tables = sweep.shard.parts > 1 ? 0 : table_bytes(options.files, sweep);
    const fs::path path = options.files.empty() ? fs::temp_directory_path() / "hertzline-sweep"
                                                : fs::path(options.files.front());
    if (const auto shortage = measures::disk_shortage(path, journal + tables)) {
        throw std::runtime_error(*shortage);
    }
    spdlog::info("{}; {} to run, on {} {}; about {} of disk and {} of memory", sweep.plan.text(), missing,
                 threads, threads == 1 ? "thread" : "threads", measures::human_bytes(journal + tables),
                 measures::human_bytes(memory));
}

void tell_of_refused(const studies::SweepSurvey& survey, std::int64_t points) {
    if (survey.refused > 0) {
        spdlog::warn("{} of {} points cannot be simulated; {}", survey.refused, points, survey.first_refused);
    }
}

/// The first point alone tells how long the others will take, roughly.
PointCounts run_missing(const Sweep& sweep, Journal& journal, const std::vector<std::int64_t>& missing,
                        int threads) {
    const std::atomic<bool>& stop = stop_asked();
    SweepProgress progress(static_cast<std::int64_t>(missing.size()));
    PointCounts first;
    if (!missing.empty()) {
        first = studies::run_points(sweep, journal, std::span(missing).first(1), 1, stop,
                                    [](const PointCounts&) {});
        const double left = progress.elapsed_s() * static_cast<double>(missing.size() - 1) / threads;
        spdlog::info("the first point took {}: about {} for all", time_text(progress.elapsed_s()),
                     time_text(progress.elapsed_s() + left));
    }
    PointCounts others;
    if (missing.size() > 1) {
        others = studies::run_points(sweep, journal, std::span(missing).subspan(1), threads, stop,
                                     [&](PointCounts done) { progress.tell(done += first); });
    }
    return others += first;
}

Exit stopped(const SweepOptions& options, const Journal& journal, const PointCounts& counts,
             std::int64_t all) {
    if (options.files.empty() || !journal.has_rows()) {
        spdlog::error("stopped after {} of {} points; nothing was saved", counts.all(), all);
    } else {
        spdlog::error(
            "stopped after {} of {} points, which are in {}: the same command with --resume goes on",
            counts.all(), all, journal.path().string());
    }
    return Exit::failed;
}

/// What is missing, and what to do next when that cannot be gone on with.
PointCounts run_or_tell(const SweepOptions& options, const Sweep& sweep, Journal& journal,
                        const std::vector<std::int64_t>& missing, int threads) {
    try {
        return run_missing(sweep, journal, missing, threads);
    } catch (const std::runtime_error& error) {
        if (options.files.empty() || !journal.has_rows()) {
            throw;
        }
        throw std::runtime_error(
            fmt::format("{}; the points that are done are in {}: the same command with --resume goes on",
                        error.what(), journal.path().string()));
    }
}

/// Writes the files from a journal that has all rows. @returns whether all is written
bool finish(const SweepOptions& options, const Sweep& sweep, Journal& journal, std::int64_t failed) {
    if (!write_result(options, studies::SweepTable(sweep, {&journal}))) {
        return false;
    }
    if (options.files.empty()) {
        return true;
    }
    if (failed > 0) {
        spdlog::error("{} points failed for want of means; --resume tries them again from {}", failed,
                      journal.path().string());
    } else {
        journal.replace_by(options.files);
    }
    return true;
}

Exit run_sweep(const SweepOptions& options) {
    const SoundSweep sound = sound_sweep(options);
    const Sweep& sweep = sound.sweep;
    const bool whole = sweep.shard.parts == 1;
    const int threads = jobs_of(options);
    if (whole) {
        std::ranges::for_each(options.files, recordings::require_writable);
    }
    if (!options.files.empty()) {
        refuse_other_parts(options.shard, options.files.front(), sweep.shard);
    }
    tell_of_refused(sound.survey, sweep.plan.size());
    Journal journal = open_journal(options, sweep);
    prepare(journal, sweep, options.resume);
    stop_asked();  // from here on there are rows to be saved
    PointCounts there;
    const std::vector<std::int64_t> missing = missing_points(sweep, journal, there);
    const std::int64_t all = there.all() + static_cast<std::int64_t>(missing.size());
    if (there.all() > 0) {
        spdlog::info("{} of {} points are in {}", there.all(), all, journal.path().string());
    }
    const UnusedJournal unused(journal, !missing.empty());
    refuse_shortages(options, sound, missing.size(), threads);
    PointCounts counts = run_or_tell(options, sweep, journal, missing, threads);
    counts += there;
    if (counts.all() < all) {
        return stopped(options, journal, counts, all);
    }
    if (const std::string faults = counts.faults(); !faults.empty()) {
        spdlog::warn("{} of {} points are not ok: {}; their messages say why",
                     counts.all() - counts[PointStatus::ok], all, faults);
    }
    const std::int64_t failed = counts[PointStatus::failed];
    if (whole && !finish(options, sweep, journal, failed)) {
        return stopped(options, journal, counts, all);
    }
    print_counts(options, counts, whole ? options.files : std::vector{journal.path().string()});
    return failed > 0 ? Exit::failed : Exit::done;
}

}  // namespace

Run sweep_command(CLI::App& app) {
    auto options = std::make_shared<SweepOptions>();
    add_sweep_options(app, *options);
    return [options] {
        if (!options->parts.empty()) {
            return merge_parts(*options);
        }
        if (options->scene.scene.empty()) {
            throw WrongUse("SCENE: found none, allowed: a scene file, or the name of a shipped scene");
        }
        return run_sweep(*options);
    };
}

}  // namespace hertzline::app
