#pragma once
// Recordings as HDF5: a dataset for each quantity.
//
//     /v_last, /v_plate, /v_out   [sample]
//     /v_chain, /x_chain          [sample][sphere]; each with its "units"
//     /captures                   [k][2]: from this row on the samples are those of the run from this one on;
//                                 the first entry is always there, each further one is a gap
//     attributes of the root      sample_rate_hz; columns, provenance: JSON
//
// The HDF5 library is not thread-safe. A writer or reader belongs to one thread at a time; several of them may be
// in several threads, since each waits for the others here, as long as nobody else in the process uses HDF5.

#include <filesystem>
#include <memory>

#include "recordings/child_process.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Creates FILE.partial-...; commit() gives it its name. Memory: at most 1 MiB for each dataset.
std::unique_ptr<RecordingWriter> open_hdf5_writer(const std::filesystem::path& path,
                                                  const RecordingHead& head);

/// Reads what the writer wrote, no other HDF5 files, in a child process: the library (1.10.8) crashes on damaged files,
/// does not return, or asks for all memory.
std::unique_ptr<RecordingReader> open_hdf5_reader(const std::filesystem::path& path,
                                                  const ChildLimits& limits = {});

/// The same in this process, for files that it wrote itself.
std::unique_ptr<RecordingReader> open_own_hdf5(const std::filesystem::path& path);

}  // namespace hertzline::recordings
