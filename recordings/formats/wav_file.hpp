#pragma once
// The chunks of a WAV: RIFF, RIFX (big-endian), and RF64 or BW64 for more than 4 GiB. Programs that write to a pipe, and
// recorders that were cut off, do not know the length of the samples: these reach to the end of the file then.

#include <cstdint>
#include <string>

#include "recordings/file_numbers.hpp"
#include "recordings/files/input_file.hpp"

namespace hertzline::recordings {

/// The place and the form of a WAV's samples, and its texts.
struct WavContents {
    FileNumber numbers;
    std::uint64_t channels = 0;
    std::uint64_t sample_rate_hz = 0;
    std::uint64_t begin = 0;  ///< the byte of the first sample
    std::uint64_t rows = 0;
    std::uint64_t left_out_bytes = 0;  ///< behind the rows: no whole row, of no chunk, or samples again
    std::string description;           ///< of the chunk hzln
    std::string comment;               ///< LIST/INFO, ICMT
};

/// @throws std::runtime_error that names path and place when it is no WAV, is damaged or compressed
WavContents read_wav(InputFile& file);

}  // namespace hertzline::recordings
