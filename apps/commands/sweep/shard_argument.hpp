#pragma once
// --shard: which part of a sweep this process runs, by hand or from what a launcher has put into the environment.

#include <string>

#include "studies/sweep/sweep.hpp"
#include <tl/expected.hpp>

namespace hertzline::app {

/// Reads "I/N", "slurm", "slurm/N" or "mpi"; empty: all. Or returns the fault, also where the environment names no part.
tl::expected<studies::Shard, std::string> shard_argument(const std::string& text);

/// The journal of a sweep or of its part: FILE.journal, or FILE.1-of-4.journal.
std::string journal_name(const std::string& file, const studies::Shard& shard);

/// @throws WrongUse when a launcher has named the part, and parts of another number of parts lie beside it: a part that is submitted again
/// alone would be taken for all. @param text of --shard
void refuse_other_parts(const std::string& text, const std::string& file, const studies::Shard& shard);

}  // namespace hertzline::app
