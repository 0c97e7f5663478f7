// hertzline sweep: many scenes, a row each.

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "measures/resources.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/sweep/sweep_table.hpp"
#include "studies/sweep/workers.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.hpp"
#include "apps/commands/sweep/shard_argument.hpp"
#include "apps/commands/sweep/study_session.hpp"
#include "apps/commands/sweep/sweep_merge.hpp"
#include "apps/commands/sweep/sweep_options.hpp"
#include "apps/commands/sweep/sweep_progress.hpp"
#include "apps/commands/sweep/sweep_result.hpp"
#include "apps/console/signals.hpp"

namespace hertzline::app {

namespace {

using studies::Journal;
using studies::PointCounts;
using studies::PointStatus;
using studies::Sweep;

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

void refuse_shortages(const SweepOptions& options, const SoundSweep& sound, std::size_t missing, int jobs) {
    const Sweep& sweep = sound.sweep;
    const double points_bytes =
        16 * static_cast<double>(sweep.plan.size());  // the list of those that are missing
    const double journal =
        Journal::bytes(static_cast<double>(missing), studies::columns_of(sweep), sweep.samples());
    const double tables = sweep.shard.parts > 1 ? 0 : table_bytes(options.files, sweep);
    StudyNeeds needs{jobs * sound.survey.memory_bytes + points_bytes, journal + tables};
    if (options.files.empty()) {
        needs = {needs.memory_bytes + journal, 0};
    }
    refuse_shortages(options, "a sweep", jobs, needs);
    spdlog::info("{}; {} to run, on {} {}; about {} of disk and {} of memory", sweep.plan.text(), missing,
                 jobs, jobs == 1 ? "thread" : "threads", measures::human_bytes(needs.disk_bytes),
                 measures::human_bytes(needs.memory_bytes));
}

void warn_of_refused(const studies::SweepSurvey& survey, std::int64_t points) {
    if (survey.refused > 0) {
        spdlog::warn("{} of {} points cannot be simulated; {}", survey.refused, points, survey.first_refused);
    }
}

/// Runs the first point alone: it tells how long the others will take, roughly.
PointCounts run_missing(const Sweep& sweep, Journal& journal, const std::vector<std::int64_t>& missing,
                        int jobs) {
    const std::atomic<bool>& stop = stop_asked();
    SweepProgress progress(static_cast<std::int64_t>(missing.size()));
    PointCounts first;
    if (!missing.empty()) {
        first = studies::run_points(sweep, journal, std::span(missing).first(1), 1, stop,
                                    [](const PointCounts&) {});
        const double left = progress.elapsed_s() * static_cast<double>(missing.size() - 1) / jobs;
        spdlog::info("the first point took {}: about {} for all", time_text(progress.elapsed_s()),
                     time_text(progress.elapsed_s() + left));
    }
    PointCounts others;
    if (missing.size() > 1) {
        others = studies::run_points(sweep, journal, std::span(missing).subspan(1), jobs, stop,
                                     [&](PointCounts done) { progress.tell(done += first); });
    }
    return others += first;
}

/// Writes the files from a journal that has all rows. @returns whether all is written
bool finish(const SweepOptions& options, const Sweep& sweep, Journal& journal, std::int64_t failed) {
    if (!write_result(options, sweep, studies::table_of(sweep, std::span(&journal, 1)))) {
        return false;
    }
    if (options.files.empty()) {
        return true;
    }
    if (failed > 0) {
        spdlog::error("{} points ran out of memory; --resume tries them again from {}", failed,
                      journal.path().string());
    } else {
        journal.replace_by(options.files);
    }
    return true;
}

/// Leaves a table as it is that has all points.
Exit tell_finished(const SweepOptions& options, const Sweep& sweep) {
    spdlog::info("{} is complete, and stays as it is", options.files.front());
    PointCounts counts;
    for (const recordings::TableRow& row : recordings::read_table_rows(
             options.files.front(), studies::records_name, studies::columns_of(sweep))) {
        ++counts[studies::result_of(sweep, row).status];
        if (options.format == Format::json) {
            print(json_text(studies::row_json(sweep, row)) + '\n');
        }
    }
    print_counts(options, counts, options.files);
    return Exit::done;
}

Exit run_sweep(const SweepOptions& options) {
    Faults faults;
    const std::optional<SoundSweep> sound = sound_sweep(options, faults);
    faults.refuse<WrongUse>();
    const Sweep& sweep = sound->sweep;
    const bool whole = sweep.shard.parts == 1;
    const int jobs = jobs_of(options);
    if (!options.files.empty()) {
        refuse_other_parts(options.shard, options.files.front(), sweep.shard);
    }
    if (finished_table(options, sweep)) {
        return tell_finished(options, sweep);
    }
    if (whole) {
        std::ranges::for_each(options.files, recordings::require_writable);
    }
    warn_of_refused(sound->survey, sweep.plan.size());
    Journal journal = open_journal(options, sweep.shard);
    begin_or_compare(journal, sweep, options.resume);
    studies::load_rows(journal, sweep);
    stop_asked();  // from here on there are rows to be saved
    PointCounts there;
    const std::vector<std::int64_t> missing = missing_points(sweep, journal, there);
    const std::int64_t all = there.all() + static_cast<std::int64_t>(missing.size());
    if (there.all() > 0) {
        spdlog::info("{} of {} points are in {}", there.all(), all, journal.path().string());
    }
    const UnusedJournal unused(journal, !missing.empty());
    refuse_shortages(options, *sound, missing.size(), jobs);
    PointCounts counts = there;
    run_to_journal(journal, [&] { counts += run_missing(sweep, journal, missing, jobs); });
    const std::string done = fmt::format("{} of {} points", counts.all(), all);
    if (counts.all() < all) {
        return stopped(journal, done);
    }
    if (const std::string failures = counts.faults(); !failures.empty()) {
        spdlog::warn("{} of {} points are not ok: {}; their messages say why",
                     counts.all() - counts[PointStatus::ok], all, failures);
    }
    const std::int64_t failed = counts[PointStatus::failed];
    if (whole && !finish(options, sweep, journal, failed)) {
        return stopped(journal, done);
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
            throw WrongUse("SCENE is missing: give a scene file, or the name of a shipped scene");
        }
        return run_sweep(*options);
    };
}

}  // namespace hertzline::app
