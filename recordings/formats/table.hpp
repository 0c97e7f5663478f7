#pragma once
// Columns of numbers that are no samples in time, such as spectra, in a file. Its ending picks the format:
//
//     .csv   a line of column names, then a line for each row; units and provenance lie beside it, as of a recording
//     .npy   two arrays: structured with a field for each column, then text, JSON: columns with units, provenance
//     .h5    a dataset for each column, called as its quantity, with its "units"; "columns" and "provenance" at the root

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recordings/recording.hpp"

#include "core/scene/json.hpp"

namespace hertzline::recordings {

struct TableColumn {
    Column about;
    std::vector<double> values;
};

struct Table {
    std::vector<TableColumn> columns;  ///< at least one, all as long; the first is what the others are over
    Json provenance;

    std::size_t rows() const noexcept { return columns.front().values.size(); }
};

/// [[name, quantity, unit]...], as of recordings.
Json table_columns_json(const Table& table);

/// Every ending that a table can have: ".csv, .npy, .h5".
std::string table_endings();

/// Why no table can have that name; nothing when it can.
std::optional<std::string> table_fault(const std::filesystem::path& path);

/// Bytes of a table, from above.
double table_bytes(const std::filesystem::path& path, double columns, double rows) noexcept;

/// Writes the table. The file has its name when it is complete. False, and nothing is left, once `stop` is true.
/// @throws std::runtime_error that names the path and the reason; then nothing is left, either
bool write_table(const std::filesystem::path& path, const Table& table, const std::atomic<bool>& stop);

}  // namespace hertzline::recordings
