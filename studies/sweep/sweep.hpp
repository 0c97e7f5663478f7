#pragma once
// A sweep: a plan and what is kept of its points. Its identity is what must be equal for rows to belong together.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

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
    Json search = nullptr;  ///< what its files say instead of the plan, where a search chose the points
};

/// What made the numbers: program, version, git_hash, compiler, simd_target. With another one of these they may have other bits.
Json maker_json();

/// What a journal's text says of what made its rows, the same keys. @throws std::runtime_error when it does not
Json maker_of_journal(const std::string& text);

/// The sweep as the text of its journal.
std::string journal_text(const Sweep& sweep);

/// The sweep of a journal's text. @throws std::runtime_error that says what is wrong, without the path
Sweep sweep_of_journal(const std::string& text);

/// In what a journal is of another sweep, as "the instruction set AVX3 where this sweep has AVX2"; nothing when it is of this one.
/// @param beside_shard the part may be another one
std::optional<std::string> journal_difference(const std::string& journal, const std::string& wanted,
                                              bool beside_shard = false);

/// Bytes of a row's payload in the journal.
std::size_t payload_bytes(const PointDemand& demand) noexcept;
/// A row as bytes. Longer messages are cut between two words.
void encode(const PointResult& result, std::span<std::byte> payload);
PointResult decode(std::int64_t point, PointStatus status, const PointDemand& demand,
                   std::span<const std::byte> payload);

inline constexpr std::size_t max_message_bytes = 504;
inline constexpr std::size_t integrator_bytes = 16;
inline constexpr std::size_t hash_bytes = 16;

}  // namespace hertzline::studies
