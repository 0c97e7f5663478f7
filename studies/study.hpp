#pragma once
// A study: the points of a plan, the options of its rows, and its table. The points of a sweep are known from the beginning; a search
// adds them batch by batch. Rows belong together when their studies have the same identity.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"
#include "measures/run.hpp"
#include "recordings/formats/table.hpp"
#include "studies/journal.hpp"
#include "studies/plan.hpp"
#include "studies/point.hpp"

namespace hertzline {
class Faults;
}

namespace hertzline::studies {

/// A part of a sweep, for one process: number `part` of `parts`, from 1. Points are dealt in turn.
struct Shard {
    std::int64_t part = 1;
    std::int64_t parts = 1;

    bool operator==(const Shard&) const = default;
};

struct Study {
    SweepPlan plan;
    PointOptions options;
    Shard shard;
    Json search = nullptr;   ///< the request of a search, which its files have in place of the plan
    Json records = nullptr;  ///< varied_records() at its begin

    bool is_search() const noexcept { return !search.is_null(); }
    std::size_t samples() const noexcept { return options.waveform_size(); }
};

/// The points of a plan, all together.
struct PlanSummary {
    std::int64_t refused = 0;   ///< points whose scene is refused: rows without numbers
    std::string first_refused;  ///< the first of them, with the reason
    double memory_bytes = 0;    ///< of the largest point, without its waveform
    TapSet taps;                ///< taps that any point has
    bool modal = false;         ///< whether any point has a modal plate
    double rows = 0;            ///< of the longest point
    ChannelCounts counts;       ///< the most of each

    /// The taps that some point has; all taps when no point can run.
    TapSet there() const noexcept { return taps.empty() ? all_taps : taps; }
    /// Those of them that have numbers of their own.
    TapSet measurable() const noexcept { return there() & measures::measurable_taps; }
};

/// The hashes of the files that drive.file of the points names, by name: their content belongs to a study as the scene does. Null where
/// the key does not vary, and for a file that cannot be read.
Json varied_records(const SweepPlan& plan);

/// Whether the key varies.
bool varies(const SweepPlan& plan, std::string_view key);

/// Lets a study keep the samples of the tap of that name, or adds its fault. @param subject of the fault
void keep_waveforms(PointOptions& options, std::string_view name, const PlanSummary& plan,
                    std::string_view subject, Faults& faults);

/// Looks at the scene of every point. @param measured beside v_out @param stop true: no more; null: never
PlanSummary summary_of(const SweepPlan& plan, TapSet measured, const std::atomic<bool>* stop = nullptr);

/// Returns the text of the study's journal.
std::string journal_text(const Study& study);

/// Returns the sweep of a journal's text. @throws std::runtime_error with the fault, without the path
Study sweep_of_journal(const std::string& text);

/// Returns the provenance that files have: maker, base scene, and plan or search.
Json provenance_of(const Study& study);

/// Returns the first difference between a journal and a study, e.g. "the instruction set AVX3 where this sweep has AVX2".
/// @param but members that may differ, e.g. "shard"
std::optional<std::string> journal_difference(const std::string& journal, const Study& wanted,
                                              std::initializer_list<std::string_view> but = {});

/// Returns the first difference between the study of a table and a study.
std::optional<std::string> table_difference(const recordings::WrittenTable& written, const Study& wanted,
                                            std::initializer_list<std::string_view> but = {});

inline constexpr std::size_t max_message_bytes = 504;

/// Returns the columns of a study's table: point, the keys that vary, status, the numbers, integrator, scene_hash, message.
std::vector<recordings::TableColumn> columns_of(const Study& study);

/// Returns a result as a row of that table. Messages longer than max_message_bytes are cut between two words.
recordings::TableRow row_of(const Study& study, const PointResult& result);
/// Returns the result of a row.
PointResult result_of(const Study& study, const recordings::TableRow& row);
/// Returns a row as a JSON object, with null for absent numbers.
Json row_json(const Study& study, const recordings::TableRow& row);

/// The dataset of an HDF5 file that holds the table.
inline constexpr const char* records_name = "points";

/// Returns the table of all points. @param parts the loaded journals of part 1, 2, ..., with all rows; they outlive the table
recordings::Table table_of(const Study& study, std::span<const Journal> parts);

/// Loads the rows of the study from its journal.
void load_rows(Journal& journal, const Study& study);

}  // namespace hertzline::studies
