#pragma once
// What a sweep gives when its points are done: the file, the rows on stdout, and the counts.

#include <string>

#include "apps/commands/sweep/sweep_options.hpp"
#include "stream/sweep/sweep_table.hpp"
#include "stream/sweep/workers.hpp"

namespace hertzline::app {

/// @throws WrongUse when there is neither a file nor --json
void refuse_no_output(const SweepOptions& options);

/// @throws std::runtime_error when the journal's rows are not as long as those of the sweep
void require_rows_of(const stream::Sweep& sweep, const stream::Journal& journal);

/// Writes the file, and prints the rows where --json asks for them. @returns whether all is written: false once the user stops it
bool write_result(const SweepOptions& options, const stream::SweepTable& table);

/// The summary, unless stdout has the rows.
void print_counts(const SweepOptions& options, const stream::PointCounts& counts, const std::string& file);

}  // namespace hertzline::app
