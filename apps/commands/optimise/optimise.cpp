// hertzline optimise: the best point of ranges, under bounds.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.hpp"
#include "apps/commands/optimise/optimise_options.hpp"
#include "apps/commands/sweep/study_session.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/json.hpp"
#include "measures/resources.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/search_report.hpp"
#include "studies/study.hpp"

namespace hertzline::app {

namespace {

using studies::Journal;
using studies::SearchJob;
using studies::SearchRequest;

/// The evaluations of a finished search, which --resume finds in its table.
struct EarlierSearch {
    std::vector<recordings::TableRow> rows;
    std::int64_t evaluations = 0;  ///< its budget
    std::int64_t after = 0;        ///< evaluations of a search before it
};

std::optional<EarlierSearch> earlier_search(const SweepOptions& options, const SearchRequest& request) {
    const studies::Study study = study_of(request);
    const auto written = finished_table(options, study, {"evaluations", "after"});
    if (!written) {
        return std::nullopt;
    }
    const Json& search = written->provenance["search"];
    return EarlierSearch{
        recordings::read_table_rows(options.files.front(), studies::records_name, studies::columns_of(study)),
        search.value("evaluations", std::int64_t{0}), search.value("after", std::int64_t{0})};
}

/// Returns the number of an earlier search's evaluations in a journal.
std::int64_t evaluations_before(const Journal& journal) {
    const Json json = json_from_outside(journal.text());
    const Json after = json.is_object() ? json.value("after", Json()) : Json();
    return after.is_number_integer() ? after.get<std::int64_t>() : 0;
}

void load(Journal& journal, const SearchRequest& request, const std::vector<recordings::TableRow>& rows) {
    const studies::Study study = study_of(request);
    journal.load(studies::columns_of(study), study.samples(), request.evaluations);
    for (const recordings::TableRow& row : rows) {
        journal.append(studies::result_of(study, row).status, row);
    }
    journal.commit();
}

void refuse_search_shortages(const SweepOptions& options, const ValidatedSearch& search) {
    const SearchRequest& request = search.request;
    const int jobs = jobs_of(options);
    const auto points = static_cast<double>(request.evaluations);
    constexpr double point_bytes = 500;  // of an evaluation in memory
    const studies::Study study = study_of(request);
    const auto tables = static_cast<double>(options.files.size());
    const StudyNeeds needs{
        jobs * search.summary.memory_bytes + points * point_bytes,
        (1 + tables) * Journal::bytes(points, studies::columns_of(study), study.samples())};
    refuse_shortages(options, "a search", jobs, needs);
    spdlog::info("{} evaluations at most, on {} {}; about {} of disk and {} of memory", request.evaluations,
                 jobs, jobs == 1 ? "thread" : "threads", measures::human_bytes(needs.disk_bytes),
                 measures::human_bytes(needs.memory_bytes));
}

Exit report(const SearchJob& job, const SweepOptions& options) {
    for (const std::string& warning : studies::search_warnings(job)) {
        spdlog::warn(warning);
    }
    print_summary(studies::search_summary(job, names_json(options.files)), options.format);
    if (job.result().best.centre == studies::Evaluations::none) {
        spdlog::error(studies::no_feasible_text(job));
        return Exit::failed;
    }
    return Exit::done;
}

/// Reports on a finished table, which stays unchanged; its summary follows from its rows.
Exit report_finished(const SweepOptions& options, SearchRequest request, const EarlierSearch& earlier) {
    spdlog::info("{} is complete with {} evaluations, and stays as it is", options.files.front(),
                 earlier.rows.size());
    request.evaluations = earlier.evaluations;
    request.after = earlier.after;
    Journal journal = Journal::in_memory();
    begin_or_compare(journal, study_of(request), false);
    load(journal, request, earlier.rows);
    SearchJob job(request, journal, jobs_of(options), stop_asked(), [](std::int64_t) {});
    job.run();
    return report(job, options);
}

Exit optimise(const OptimiseOptions& options) {
    ValidatedSearch search = validated_search(options);
    SearchRequest& request = search.request;
    const std::vector<std::string>& files = options.sweep.files;
    const auto earlier = earlier_search(options.sweep, request);
    if (earlier && earlier->evaluations >= request.evaluations) {
        return report_finished(options.sweep, request, *earlier);
    }
    std::ranges::for_each(files, recordings::require_writable);
    if (search.summary.refused > 0) {
        spdlog::warn("{} of {} points all over the ranges cannot be simulated; {}", search.summary.refused,
                     request.evaluations, search.summary.first_refused);
    }
    Journal journal = open_journal(options.sweep, {});
    if (earlier) {
        request.after = static_cast<std::int64_t>(earlier->rows.size());
        spdlog::info("{} evaluations are in {}; the search continues from them", request.after,
                     files.front());
    } else if (!journal.is_new()) {
        request.after = std::clamp<std::int64_t>(evaluations_before(journal), 0, request.evaluations);
    }
    begin_or_compare(journal, study_of(request), options.sweep.resume && !earlier);
    load(journal, request, earlier ? earlier->rows : std::vector<recordings::TableRow>());
    const UnusedJournal unused(journal, true);
    stop_asked();  // from here on a signal saves the rows
    refuse_search_shortages(options.sweep, search);
    StudyProgress progress(request.evaluations);
    SearchJob job(request, journal, jobs_of(options.sweep), stop_asked(),
                  [&](std::int64_t done) { progress.show({{done}}); });
    run_to_journal(journal, [&] { job.run(); });
    const std::string done = fmt::format("{} evaluations", job.evaluations().size());
    if (job.evaluations().stopped() ||
        !write_tables(files, studies::table_of(job.study(), std::span(&journal, 1)))) {
        return stopped(journal, done);
    }
    const Exit exit = report(job, options.sweep);
    journal.replace_by(files);
    return exit;
}

}  // namespace

Run optimise_command(CLI::App& app) {
    auto options = std::make_shared<OptimiseOptions>();
    add_optimise_options(app, *options);
    return [options] { return optimise(*options); };
}

}  // namespace hertzline::app
