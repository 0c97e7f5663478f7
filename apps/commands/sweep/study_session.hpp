#pragma once
// A study at work, whether a sweep or a search: its journal, new or resumed, its progress, and the tables that replace the journal.

#include <chrono>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/command.hpp"
#include "apps/commands/sweep/sweep_options.hpp"
#include "apps/console/progress.hpp"
#include "recordings/formats/table.hpp"
#include "studies/journal.hpp"
#include "studies/study.hpp"
#include "studies/workers.hpp"

namespace hertzline::app {

/// Returns the finished table that --resume finds in place of a journal; nothing when a file of -o is missing.
/// @param but members of its identity that may differ (studies::table_difference)
/// @throws WrongUse when a file is of another study: it would be replaced
std::optional<recordings::WrittenTable> finished_table(const SweepOptions& options,
                                                       const studies::Study& study,
                                                       std::initializer_list<std::string_view> but = {});

/// Opens the journal of the options' first file; without files one in memory.
studies::Journal open_journal(const SweepOptions& options, const studies::Shard& shard);

/// Begins a new journal, or compares an existing one with the study.
/// @throws WrongUse with the difference
void begin_or_compare(studies::Journal& journal, const studies::Study& study, bool resume);

/// Removes a journal without rows at the end, unless none were wanted.
class UnusedJournal {
public:
    UnusedJournal(studies::Journal& journal, bool wants_rows) : journal_(journal), wants_rows_(wants_rows) {}
    ~UnusedJournal() {
        if (wants_rows_ && !journal_.has_rows()) {
            journal_.remove();
        }
    }
    UnusedJournal(const UnusedJournal&) = delete;
    UnusedJournal& operator=(const UnusedJournal&) = delete;

private:
    studies::Journal& journal_;
    bool wants_rows_;
};

/// Memory and disk that a study needs.
struct StudyNeeds {
    double memory_bytes = 0;
    double disk_bytes = 0;  ///< journal and tables
};

/// @throws std::runtime_error when the memory is too small for a study ("a sweep") with so many jobs
void refuse_memory_shortage(std::string_view study, int jobs, double bytes);

/// @throws std::runtime_error when memory or disk do not suffice. @param study "a sweep"
void refuse_shortages(const SweepOptions& options, std::string_view study, int jobs, const StudyNeeds& needs);

/// Runs the work, which adds rows, and commits them, also when it fails: the error then says how to continue.
void run_to_journal(studies::Journal& journal, const std::function<void()>& work);

/// Reports that the user has stopped the study. @param done "3 of 40 points"
Exit stopped(const studies::Journal& journal, std::string_view done);

/// Returns a line of progress: " 42 %  420 of 1000 points, 251 points/s, 2.31 s left; 3 refused".
std::string progress_text(const studies::PointCounts& done, std::int64_t all, double elapsed_s);

/// The progress of a study: a line that is overwritten on a terminal, elsewhere a message every few seconds.
class StudyProgress {
public:
    /// @param all points to be run
    explicit StudyProgress(std::int64_t all);

    void show(const studies::PointCounts& done);

    /// Time since construction [s].
    double elapsed_s() const;

private:
    using Clock = std::chrono::steady_clock;

    std::int64_t all_;
    bool terminal_;
    ProgressLine line_;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_message_ = start_;
};

/// Returns an upper bound of the size of all tables [bytes].
double table_bytes(std::span<const std::string> files, const studies::Study& study);

/// Writes the tables. @returns false when the user stops it
bool write_tables(std::span<const std::string> files, const recordings::Table& table);

/// Writes the tables, and prints the rows with --json. @returns false when the user stops it
bool write_result(const SweepOptions& options, const studies::Study& study, const recordings::Table& table);

/// Returns the names for a summary: a text, or several.
Json names_json(const std::vector<std::string>& files);

/// Prints the counts of points, unless stdout has the rows.
void print_counts(const SweepOptions& options, const studies::PointCounts& counts,
                  const std::vector<std::string>& files);

}  // namespace hertzline::app
