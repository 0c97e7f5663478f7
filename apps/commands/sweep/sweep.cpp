// hertzline sweep: many scenes, a row each.

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.hpp"
#include "apps/commands/sweep/shard_argument.hpp"
#include "apps/commands/sweep/study_session.hpp"
#include "apps/commands/sweep/sweep_merge.hpp"
#include "apps/commands/sweep/sweep_options.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "measures/resources.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/study.hpp"
#include "studies/workers.hpp"

namespace hertzline::app {

namespace {

using studies::Journal;
using studies::PointCounts;
using studies::PointStatus;
using studies::Study;

/// Returns the points of this part without a row, or with one that is tried again, and counts the others.
std::vector<std::int64_t> missing_points(const Study& study, const Journal& journal, PointCounts& finished) {
    std::vector<std::int64_t> missing;
    for (std::int64_t point = study.shard.part - 1; point < study.plan.size(); point += study.shard.parts) {
        if (!journal.has(point) || journal.status(point) == PointStatus::failed) {
            missing.push_back(point);
        } else {
            ++finished[journal.status(point)];
        }
    }
    return missing;
}

void refuse_sweep_shortages(const SweepOptions& options, const ValidatedSweep& sweep, std::size_t missing,
                            int jobs) {
    const Study& study = sweep.study;
    const double points_bytes = 16 * static_cast<double>(study.plan.size());  // the list of missing points
    const double journal =
        Journal::bytes(static_cast<double>(missing), studies::columns_of(study), study.samples());
    const double tables = study.shard.parts > 1 ? 0 : table_bytes(options.files, study);
    StudyNeeds needs{jobs * sweep.summary.memory_bytes + points_bytes, journal + tables};
    if (options.files.empty()) {
        needs = {needs.memory_bytes + journal, 0};
    }
    refuse_shortages(options, "a sweep", jobs, needs);
    spdlog::info("{}; {} to run, on {} {}; about {} of disk and {} of memory", study.plan.text(), missing,
                 jobs, jobs == 1 ? "thread" : "threads", measures::human_bytes(needs.disk_bytes),
                 measures::human_bytes(needs.memory_bytes));
}

void warn_of_refused(const studies::PlanSummary& summary, std::int64_t points) {
    if (summary.refused > 0) {
        spdlog::warn("{} of {} points cannot be simulated; {}", summary.refused, points,
                     summary.first_refused);
    }
}

/// Runs the first point alone, to estimate the time of the others.
PointCounts run_missing(const Study& study, Journal& journal, const std::vector<std::int64_t>& missing,
                        int jobs) {
    const std::atomic<bool>& stop = stop_asked();
    StudyProgress progress(static_cast<std::int64_t>(missing.size()));
    PointCounts first;
    if (!missing.empty()) {
        first = studies::run_points(study, journal, std::span(missing).first(1), 1, stop,
                                    [](const PointCounts&) {});
        const double left = progress.elapsed_s() * static_cast<double>(missing.size() - 1) / jobs;
        spdlog::info("the first point took {}: about {} for all", time_text(progress.elapsed_s()),
                     time_text(progress.elapsed_s() + left));
    }
    PointCounts others;
    if (missing.size() > 1) {
        others = studies::run_points(study, journal, std::span(missing).subspan(1), jobs, stop,
                                     [&](PointCounts done) { progress.show(done += first); });
    }
    return others += first;
}

/// Writes the files from a journal with all rows. @returns false when the user stops it
bool finish(const SweepOptions& options, const Study& study, Journal& journal, std::int64_t failed) {
    if (!write_result(options, study, studies::table_of(study, std::span(&journal, 1)))) {
        return false;
    }
    if (options.files.empty()) {
        return true;
    }
    if (failed > 0) {
        spdlog::error(
            "{} points failed: their messages name the memory or the library that they lacked; --resume "
            "tries them again from {}",
            failed, printable_whole(journal.path().string()));
    } else {
        journal.replace_by(options.files);
    }
    return true;
}

/// Reports on a finished table, which stays unchanged.
Exit report_finished(const SweepOptions& options, const Study& study) {
    spdlog::info("{} is complete, and stays as it is", options.files.front());
    PointCounts counts;
    for (const recordings::TableRow& row : recordings::read_table_rows(
             options.files.front(), studies::records_name, studies::columns_of(study))) {
        ++counts[studies::result_of(study, row).status];
        if (options.format == Format::json) {
            print(json_text(studies::row_json(study, row)) + '\n');
        }
    }
    print_counts(options, counts, options.files);
    return Exit::done;
}

Exit run_sweep(const SweepOptions& options) {
    Faults faults;
    const std::optional<ValidatedSweep> sweep = validated_sweep(options, faults);
    faults.refuse<WrongUse>();
    const Study& study = sweep->study;
    const bool whole = study.shard.parts == 1;
    const int jobs = jobs_of(options);
    if (!options.files.empty()) {
        refuse_other_parts(options.shard, options.files.front(), study.shard);
    }
    if (finished_table(options, study)) {
        return report_finished(options, study);
    }
    if (whole) {
        std::ranges::for_each(options.files, recordings::require_writable);
    }
    warn_of_refused(sweep->summary, study.plan.size());
    Journal journal = open_journal(options, study.shard);
    begin_or_compare(journal, study, options.resume);
    studies::load_rows(journal, study);
    stop_asked();  // from here on a signal saves the rows
    PointCounts finished;
    const std::vector<std::int64_t> missing = missing_points(study, journal, finished);
    const std::int64_t all = finished.all() + static_cast<std::int64_t>(missing.size());
    if (finished.all() > 0) {
        spdlog::info("{} of {} points are in {}", finished.all(), all,
                     printable_whole(journal.path().string()));
    }
    const UnusedJournal unused(journal, !missing.empty());
    refuse_sweep_shortages(options, *sweep, missing.size(), jobs);
    PointCounts counts = finished;
    run_to_journal(journal, [&] { counts += run_missing(study, journal, missing, jobs); });
    const std::string done = fmt::format("{} of {} points", counts.all(), all);
    if (counts.all() < all) {
        return stopped(journal, done);
    }
    if (const std::string failures = counts.faults(); !failures.empty()) {
        spdlog::warn("{} of {} points are not ok: {}; their messages say why",
                     counts.all() - counts[PointStatus::ok], all, failures);
    }
    const std::int64_t failed = counts[PointStatus::failed];
    if (whole && !finish(options, study, journal, failed)) {
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
