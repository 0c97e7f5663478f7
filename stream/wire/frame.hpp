#pragma once
// The header of a frame. frame_codec reads and writes its bytes.

#include <cstddef>
#include <cstdint>
#include <string>

namespace hertzline::stream {

/// The header of n consecutive samples of one stream.
struct FrameHeader {
    std::string stream;        ///< a tap's name, "v_out"
    std::string unit = "m/s";  ///< the samples' unit
    std::uint64_t seq = 0;     ///< counts the topic's frames, from 0; a discarded frame takes a number too
    std::uint64_t sample = 0;  ///< index of the first sample since the run's start
    std::uint64_t burst =
        0;  ///< the horn's burst that the first sample lies in, from 0; 0 where bursts do not repeat
    std::uint64_t burst_sample = 0;  ///< index of the first sample since that burst's first sample
    std::uint64_t epoch = 0;    ///< counts the changes of the scene; the same for all samples of the frame
    double fs = 0;              ///< samples a second [Hz], positive
    std::uint64_t dropped = 0;  ///< frames of this run that the program itself had to discard before this one
    std::string run;            ///< the run's id, a UUID
    std::size_t n = 0;          ///< samples in the frame, at least 1
    std::size_t channels = 1;   ///< numbers per sample, at least 1

    /// Time of the first sample since the run's start [s].
    double t() const noexcept { return static_cast<double>(sample) / fs; }
    /// Bytes of the samples as float32.
    std::size_t payload_bytes() const noexcept { return n * channels * sizeof(float); }

    bool operator==(const FrameHeader&) const = default;
};

}  // namespace hertzline::stream
