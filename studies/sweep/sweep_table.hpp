#pragma once
// The table of a study, from its journals to its files: HDF5 or CSV, by the ending of the name.

#include <cstdint>
#include <span>
#include <vector>

#include "recordings/formats/table.hpp"
#include "studies/sweep/journal.hpp"
#include "studies/sweep/sweep.hpp"

namespace hertzline::studies {

/// The dataset of an HDF5 file that holds the table.
inline constexpr const char* records_name = "points";

/// All but the rows.
recordings::Table empty_table(const Sweep& sweep);

/// All points, which must be there. @param parts the journals of part 1, 2, ..., loaded; they outlive the table
recordings::Table table_of(const Sweep& sweep, std::span<const Journal> parts);

/// Tells the journal to look for the rows of its study.
void load_rows(Journal& journal, const Sweep& sweep);

}  // namespace hertzline::studies
