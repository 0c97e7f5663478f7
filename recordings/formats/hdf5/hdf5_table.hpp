#pragma once
// Tables (formats/table.hpp) as HDF5. Tables are read in this process: files that the same user's program has written.

#include <atomic>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "recordings/formats/table.hpp"

namespace hertzline::recordings {

/// [[name, quantity, unit]...], as of recordings.
Json table_columns_json(const Table& table);

/// See write_table(), read_table() and read_table_rows().
bool write_hdf5_table(const std::filesystem::path& path, const Table& table, const std::atomic<bool>& stop);
WrittenTable read_hdf5_table(const std::filesystem::path& path, const std::string& records);
std::vector<TableRow> read_hdf5_table_rows(const std::filesystem::path& path, const std::string& records,
                                           std::span<const TableColumn> columns);

}  // namespace hertzline::recordings
