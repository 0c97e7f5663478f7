#pragma once
// --shard: the part of a sweep that this process runs, as given or from the environment of a launcher.

#include <string>

#include <tl/expected.hpp>

#include "studies/study.hpp"

namespace hertzline::app {

/// Reads "I/N", "slurm", "slurm/N" or "mpi"; empty: all points. Or returns the fault, also when the environment names no
/// part.
tl::expected<studies::Shard, std::string> shard_argument(const std::string& text);

/// Returns the name of the journal of a sweep or of its part: FILE.journal, or FILE.1-of-4.journal.
std::string journal_name(const std::string& file, const studies::Shard& shard);

/// Refuses the part of a launcher beside journals with another number of parts: a part that is submitted again alone would be taken
/// for all. @param text of --shard @throws WrongUse
void refuse_other_parts(const std::string& text, const std::string& file, const studies::Shard& shard);

}  // namespace hertzline::app
