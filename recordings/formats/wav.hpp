#pragma once
// Recordings as WAV: float32, a channel for each column; RF64 where 4 GiB do not suffice.
//
// WAV has no place for most of a recording's head. An own chunk, "hzln", before the samples holds it as JSON: columns
// with units, rate and provenance. WAV cannot mark gaps either: samples after a gap follow those before it, nothing
// is filled in, and the comment (LIST/INFO, ICMT) at the file's end maps rows to samples as JSON: {"rows": 2000,
// "captures": [[0, 0], [1000, 1500]]}.
//
// Audio programs cut samples beyond 1. A recording with another full scale holds samples divided by it, and the
// comment begins with {"full_scale": 2, ...}. With a power of two no bit is lost.

#include <filesystem>
#include <memory>

#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Returns the path of the JSON with the changes of a scene that was streamed into a WAV: its description precedes them.
std::filesystem::path wav_changes_path(std::filesystem::path wav);

/// Creates FILE.partial-...; commit() gives it its name. head.numbers is taken for float32. Throws
/// std::runtime_error for a head that WAV cannot hold: rates that are no whole number, more than 1024 columns, more
/// than 2^31 - 1 bytes a second, a description beyond 48 KiB. A comment has room for some 80 gaps: before one
/// more the recording is completed, and write() throws. Warns of samples beyond the full scale.
std::unique_ptr<RecordingWriter> open_wav_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head);

/// Reads files of the writer, and WAV of others (wav_file.hpp) with PCM or floating-point samples: those have columns
/// channel_1, channel_2... without units, PCM scaled to -1...1. Samples are read as they were written, times the full
/// scale.
std::unique_ptr<RecordingReader> open_wav_reader(const std::filesystem::path& path,
                                                 const ReadOptions& options = {});

}  // namespace hertzline::recordings
