#pragma once
// The header of a frame. Only this file knows the JSON header of the .../np topics; its samples follow as float32. Writing a header
// happens per frame and topic, some 40 000 times a second: straight into a buffer that the caller keeps, no document
// tree. Reading is for listeners, which do not trust received bytes.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

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
    std::uint64_t epoch = 0;  ///< counts the changes of the scene; the same for all samples of the frame
    double fs = 0;            ///< samples a second [Hz], positive
    std::uint64_t dropped =
        0;            ///< frames of the topic that the program discarded, or did not make, before this one
    std::string run;  ///< the run's id, a UUID
    /// Of a live drive: a sample of it is heard so many samples later.
    std::optional<std::int64_t> latency_samples = {};
    std::size_t n = 0;         ///< samples in the frame, at least 1
    std::size_t channels = 1;  ///< numbers per sample, at least 1

    /// Time of the first sample since the run's start [s].
    double t() const noexcept { return static_cast<double>(sample) / fs; }
    /// Bytes of the samples as float32.
    std::size_t payload_bytes() const noexcept { return n * channels * sizeof(float); }

    bool operator==(const FrameHeader&) const = default;
};

/// Longest header that is read [bytes]. Ours have some 200; the bound keeps hostile nesting shallow.
inline constexpr std::size_t max_header_bytes = 4096;

/// Longest stream, unit or run name [characters].
inline constexpr std::size_t max_name_length = 64;

/// Replaces `json` by the header as JSON; allocates only while `json` grows. The
/// header must be one that decode_header accepts (names of printable ASCII without quotes and backslashes, fs
/// positive and finite, n and channels at least 1, counts below 2^63); anything else is misuse.
void encode_header(const FrameHeader& header, std::string& json);

/// Reads a header, or returns its fault. Never throws on bad input. `payload_bytes` is the size of
/// the part that follows and must be n * channels * 4. Unknown keys are ignored.
tl::expected<FrameHeader, std::string> decode_header(std::string_view json, std::size_t payload_bytes);

}  // namespace hertzline::stream
