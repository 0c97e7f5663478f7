#pragma once
// HDF5 files: recordings, with a dataset for each quantity, and tables (formats/table.hpp).
//
//     /v_last, /v_plate, /v_out   [sample]
//     /v_chain, /x_chain          [sample][sphere]; each with its "units"
//     /captures                   [k][2]: row, and the run's sample in that row; the first entry is always there, each
//                                 further one follows a gap
//     /changes                    [byte]: changes of the scene, JSON on a line each; only where there may be any
//     attributes of the root      sample_rate_hz; columns, provenance: JSON
//
// The HDF5 library, which writes them, is not thread-safe. A writer belongs to one thread at a time; several may be in
// several threads, since each waits for the others, as long as nothing else in the process uses HDF5.

#include <atomic>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/scene/json.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Creates FILE.partial-...; commit() gives it its name. Memory: at most 1 MiB for each dataset.
std::unique_ptr<RecordingWriter> open_hdf5_writer(const std::filesystem::path& path,
                                                  const RecordingHead& head);

/// Reads the files of the writer, without the library: see hdf5_file.hpp. Other HDF5 files are refused.
std::unique_ptr<RecordingReader> open_hdf5_reader(const std::filesystem::path& path,
                                                  const ReadOptions& options = {});

/// Columns of a table as of recordings: [[name, quantity, unit]...].
Json table_columns_json(const Table& table);

/// See write_table(), read_table() and read_table_rows(). Tables are read with the library, in this process: they are files
/// of the same user's program.
bool write_hdf5_table(const std::filesystem::path& path, const Table& table, const std::atomic<bool>& stop);
WrittenTable read_hdf5_table(const std::filesystem::path& path, const std::string& records);
std::vector<TableRow> read_hdf5_table_rows(const std::filesystem::path& path, const std::string& records,
                                           std::span<const TableColumn> columns);

}  // namespace hertzline::recordings
