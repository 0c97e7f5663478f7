#pragma once
// A study: points of a plan, and what is kept of them. A sweep knows its points from the beginning; a search adds them batch by batch.
// Its identity is what must be equal for rows to belong together.

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/formats/table.hpp"
#include "studies/sweep/plan.hpp"
#include "studies/sweep/point_result.hpp"
#include "studies/sweep/point_run.hpp"

#include "core/scene/json.hpp"

namespace hertzline::studies {

/// The part of a sweep that one process runs: of `parts` parts number `part`, from 1. Points are dealt in turn.
struct Shard {
    std::int64_t part = 1;
    std::int64_t parts = 1;

    bool has(std::int64_t point) const noexcept { return point % parts == part - 1; }
    bool operator==(const Shard&) const = default;
};

struct Sweep {
    SweepPlan plan;
    PointDemand demand;
    Shard shard;
    Json search = nullptr;  ///< what was asked of a search: its files have it instead of the plan

    bool is_search() const noexcept { return !search.is_null(); }
    std::size_t samples() const noexcept { return demand.waveform ? demand.waveform_samples : 0; }
};

/// What made the numbers: program, version, git_hash, compiler, simd_target. With another one of these they may have other bits.
Json maker_json();

/// The study as the text of its journal.
std::string journal_text(const Sweep& sweep);

/// The sweep of a journal's text. @throws std::runtime_error that says what is wrong, without the path
Sweep sweep_of_journal(const std::string& text);

/// What the files say of where their rows come from: what made them, base scene, and plan or search.
Json sweep_provenance(const Sweep& sweep);

/// In what a journal is of another study, as "the instruction set AVX3 where this sweep has AVX2"; nothing when it is of this one.
/// @param but members that may differ, as "shard"
std::optional<std::string> journal_difference(const std::string& journal, const Sweep& wanted,
                                              std::initializer_list<std::string_view> but = {});

/// The same of a table that a study has written.
std::optional<std::string> table_difference(const recordings::WrittenTable& written, const Sweep& wanted,
                                            std::initializer_list<std::string_view> but = {});

/// The columns of a study's table: point, one for each key that varies, status, the numbers, integrator, scene_hash, message.
std::vector<recordings::TableColumn> columns_of(const Sweep& sweep);

/// A result as a row of that table. Longer messages are cut between two words.
recordings::TableRow row_of(const Sweep& sweep, const PointResult& result);
/// The result of a row.
PointResult result_of(const Sweep& sweep, const recordings::TableRow& row);
/// A row as a JSON object; null where there is no number.
Json row_json(const Sweep& sweep, const recordings::TableRow& row);

inline constexpr std::size_t max_message_bytes = 504;

}  // namespace hertzline::studies
