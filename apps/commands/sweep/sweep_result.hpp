#pragma once
// What a sweep gives when its points are done: the file, the rows on stdout, and the counts.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recordings/formats/table.hpp"
#include "studies/sweep/sweep.hpp"
#include "studies/sweep/workers.hpp"

#include "apps/commands/sweep/sweep_options.hpp"
#include "core/scene/faults.hpp"

namespace hertzline::app {

/// Adds the fault of a sweep with neither a file nor --json.
void check_output(const SweepOptions& options, Faults& faults);

/// Adds the fault of each file that cannot be a sweep's table, or is named twice. @param waveform only HDF5 holds them
void check_tables(std::span<const std::string> files, std::optional<Tap> waveform, Faults& faults);

/// Bytes of all the files, from above.
double table_bytes(std::span<const std::string> files, const studies::Sweep& sweep);

/// Writes the tables. @returns whether all are written: false once the user stops it
bool write_tables(std::span<const std::string> files, const recordings::Table& table);

/// The same, and prints the rows where --json asks for them.
bool write_result(const SweepOptions& options, const studies::Sweep& sweep, const recordings::Table& table);

/// As summaries name them: a text, or several.
Json names_json(const std::vector<std::string>& files);

/// The summary, unless stdout has the rows.
void print_counts(const SweepOptions& options, const studies::PointCounts& counts,
                  const std::vector<std::string>& files);

}  // namespace hertzline::app
