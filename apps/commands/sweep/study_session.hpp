#pragma once
// A study at work, whether a sweep or a search: from its journal, new or resumed, to the tables that replace it.

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "recordings/formats/table.hpp"
#include "studies/sweep/journal.hpp"
#include "studies/sweep/sweep.hpp"

#include "apps/command.hpp"
#include "apps/commands/sweep/sweep_options.hpp"

namespace hertzline::app {

/// The finished table that --resume finds where there is no journal; nothing when not all files of -o are there.
/// @param but members of its identity that may differ (studies::table_difference)
/// @throws WrongUse when a file is of another study: it would be replaced
std::optional<recordings::WrittenTable> finished_table(const SweepOptions& options,
                                                       const studies::Sweep& sweep,
                                                       std::initializer_list<std::string_view> but = {});

/// The journal of the options' first file; without files one in memory.
studies::Journal open_journal(const SweepOptions& options, const studies::Shard& shard);

/// Begins the journal, or makes sure that it is of this study.
/// @throws WrongUse that says in what it is of another one
void begin_or_compare(studies::Journal& journal, const studies::Sweep& sweep, bool resume);

/// Removes a journal that no row has come to, where one was to come.
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

/// @throws std::runtime_error when memory or disk do not suffice. @param study "a sweep"
void refuse_shortages(const SweepOptions& options, std::string_view study, int jobs, const StudyNeeds& needs);

/// Runs the work, which adds rows, and commits them, also where it fails: then the error says how to continue.
void run_to_journal(studies::Journal& journal, const std::function<void()>& work);

/// Tells that the user has stopped it. @param done "3 of 40 points"
Exit stopped(const studies::Journal& journal, std::string_view done);

}  // namespace hertzline::app
