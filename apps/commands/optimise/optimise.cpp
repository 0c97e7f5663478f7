// hertzline optimise: the best point of ranges, under bounds.

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "measures/resources.hpp"
#include "recordings/recording_formats.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.hpp"
#include "apps/commands/optimise/optimise_options.hpp"
#include "apps/commands/optimise/search_report.hpp"
#include "apps/commands/sweep/sweep_progress.hpp"
#include "apps/commands/sweep/sweep_result.hpp"
#include "apps/commands/sweep/unused_journal.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"

namespace hertzline::app {

namespace {

using studies::Journal;
using studies::SearchJob;
using studies::SearchRequest;

constexpr const char* journal_ending = ".journal";

studies::Sweep rows_of(const SearchRequest& request) {
    std::vector<SceneKey> keys;
    for (const studies::Axis& axis : request.axes) {
        keys.push_back(axis.key);
    }
    return {studies::SweepPlan::growing(request.base, std::move(keys)), request.demand, {}};
}

Journal open_journal(const SweepOptions& options, const SearchRequest& request) {
    Journal journal(options.files.front() + journal_ending,
                    options.resume ? Journal::Use::resume : Journal::Use::begin);
    const std::string text = studies::journal_text(request);
    if (journal.is_new()) {
        if (options.resume) {
            spdlog::info("{} is not there; the search begins anew", journal.path().string());
        }
        journal.begin(text, studies::payload_bytes(request.demand));
    } else if (const auto difference = studies::search_difference(journal.text(), text)) {
        throw WrongUse(
            fmt::format("{}: found {}, allowed: the journal of the same search, made by the same program",
                        journal.path().string(), *difference));
    }
    require_rows_of(rows_of(request), journal);
    journal.load(request.evaluations);
    if (journal.damaged() > 0) {
        spdlog::warn("{}: {} damaged rows are computed again", journal.path().string(), journal.damaged());
    }
    return journal;
}

void refuse_shortages(const SweepOptions& options, const SoundSearch& search) {
    const SearchRequest& request = search.request;
    const int jobs = jobs_of(options);
    const auto points = static_cast<double>(request.evaluations);
    constexpr double point_bytes = 500;  // what is known of each
    const double memory = jobs * search.survey.memory_bytes + points * point_bytes;
    if (const auto shortage = measures::memory_shortage(fmt::format("a search with {} jobs", jobs), memory)) {
        throw std::runtime_error(*shortage + "; fewer --jobs take less");
    }
    const double row = Journal::bytes(1, studies::payload_bytes(request.demand));
    const auto tables = static_cast<double>(options.files.size());
    const double disk = (1 + tables) * points * row;  // the journal, and the tables beside it
    if (const auto shortage = measures::disk_shortage(options.files.front(), disk)) {
        throw std::runtime_error(*shortage);
    }
    spdlog::info("{} evaluations at most, on {} {}; about {} of disk and {} of memory", request.evaluations,
                 jobs, jobs == 1 ? "thread" : "threads", measures::human_bytes(disk),
                 measures::human_bytes(memory));
}

void search_or_tell(SearchJob& job, const Journal& journal) {
    try {
        job.run();
    } catch (const std::runtime_error& error) {
        if (!journal.has_rows()) {
            throw;
        }
        throw std::runtime_error(
            fmt::format("{}; the points that are done are in {}: the same command with --resume goes on",
                        error.what(), journal.path().string()));
    }
}

Exit stopped(const Journal& journal, std::int64_t evaluations) {
    if (!journal.has_rows()) {
        spdlog::error("stopped before the first point was done; nothing was saved");
    } else {
        spdlog::error("stopped after {} evaluations, which are in {}: the same command with --resume goes on",
                      evaluations, journal.path().string());
    }
    return Exit::failed;
}

Exit report(const SearchJob& job, const SweepOptions& options) {
    for (const std::string& warning : search_warnings(job)) {
        spdlog::warn(warning);
    }
    print_summary(search_summary(job, names_json(options.files)), options.format);
    if (job.result().best.centre == studies::Evaluations::none) {
        spdlog::error(no_feasible_text(job));
        return Exit::failed;
    }
    return Exit::done;
}

Exit optimise(const OptimiseOptions& options) {
    const SoundSearch search = sound_search(options);
    const std::vector<std::string>& files = options.sweep.files;
    std::ranges::for_each(files, recordings::require_writable);
    if (search.survey.refused > 0) {
        spdlog::warn("{} of {} points all over the ranges cannot be simulated; {}", search.survey.refused,
                     search.request.evaluations, search.survey.first_refused);
    }
    Journal journal = open_journal(options.sweep, search.request);
    const UnusedJournal unused(journal, true);
    stop_asked();  // from here on there are rows to be saved
    refuse_shortages(options.sweep, search);
    SweepProgress progress(search.request.evaluations);
    SearchJob job(search.request, journal, jobs_of(options.sweep), stop_asked(),
                  [&](std::int64_t done) { progress.tell({{done}}); });
    search_or_tell(job, journal);
    if (job.evaluations().stopped()) {
        return stopped(journal, job.evaluations().size());
    }
    if (!write_tables(files, studies::SweepTable(job.sweep(), {&journal}))) {
        return stopped(journal, job.evaluations().size());
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
