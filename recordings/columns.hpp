#pragma once
// The columns of recordings: which there are, and their names. They are the same in every format: those of the CSV.

#include <cstddef>
#include <string>
#include <vector>

#include "recordings/recording.hpp"

#include "core/taps.hpp"

namespace hertzline::recordings {

/// The columns of a recording of those taps: first those with one channel, then those of the spheres, sphere by sphere,
/// then those of the contacts.
std::vector<Column> recorded_columns(TapSet taps, std::size_t spheres);

/// The column of that name; one that is no tap's is a quantity of its own, its unit taken from the name.
Column column_named(const std::string& name);

}  // namespace hertzline::recordings
