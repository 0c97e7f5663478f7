#pragma once
// Recordings as NumPy's .npy: two arrays in one file, as numpy.load reads them one after the other.
//
// The first is structured, a row per sample: t_s as float64 (sample / sample rate, so that a gap shows as a
// jump) and the columns by their names. The second is text, JSON: columns with units, rate and provenance.
//
//     with open("burst.npy", "rb") as f:
//         a = np.load(f, max_header_size=10**7)        # a["v_out_m_per_s"]
//         about = json.loads(np.load(f).item())
//
// max_header_size only matters for recordings of hundreds of columns.

#include <filesystem>
#include <memory>
#include <vector>

#include "recordings/formats/npy_header.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Creates FILE.partial-...; commit() gives it its name. Memory: a buffer of 1 MiB.
std::unique_ptr<RecordingWriter> open_npy_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head);

/// Returns the fields of the writer's array: t_s and the columns.
std::vector<NpyField> npy_fields(const RecordingHead& head);

/// Reads files of the writer, and arrays of others: of one dimension, of two (rows are samples), or structured, of any numbers
/// that NumPy saves (integers as in file_numbers.hpp; a complex number makes two columns). Columns have the names of the fields,
/// or channel_1, channel_2... Without a field of times (t_s, time...) the file lacks a sample rate.
std::unique_ptr<RecordingReader> open_npy_reader(const std::filesystem::path& path,
                                                 const ReadOptions& options = {});

}  // namespace hertzline::recordings
