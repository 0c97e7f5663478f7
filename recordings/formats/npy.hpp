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

#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Creates FILE.partial-...; commit() gives it its name. Memory: a buffer of 1 MiB.
std::unique_ptr<RecordingWriter> open_npy_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head);

/// Reads files of the writer, and one- or two-dimensional arrays of float32 or float64 in C order by others: those
/// have columns channel_1, channel_2... without units, and sample_rate_hz 0, which the file lacks.
std::unique_ptr<RecordingReader> open_npy_reader(const std::filesystem::path& path);

}  // namespace hertzline::recordings
