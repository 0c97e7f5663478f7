#pragma once
// The only place that knows a frame's bytes: the JSON header of the .../np topics and float32 little-endian
// samples. Writing a header happens per frame and topic, some 40 000 times a second: straight into a buffer
// that the caller keeps, no document tree. Reading is for listeners, which trust nothing that they are sent.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "stream/wire/frame.hpp"

namespace hertzline::stream {

/// Longest header that is read [bytes]. Ours have some 200; the bound keeps hostile nesting shallow.
inline constexpr std::size_t max_header_bytes = 4096;

/// Longest stream, unit or run name [characters].
inline constexpr std::size_t max_name_length = 64;

/// Writes the header as JSON into `json`, replacing what it held; allocates only while `json` grows.
/// The header must be one that decode_header accepts (names of printable ASCII without quotes and
/// backslashes, fs positive and finite, n and channels at least 1, counts below 2^63); anything else is
/// misuse.
void encode_header(const FrameHeader& header, std::string& json);

/// Reads a header, or says what is wrong with it. Never throws on bad input. `payload_bytes` is the size of
/// the part that follows and must be n * channels * 4. Unknown keys are ignored.
tl::expected<FrameHeader, std::string> decode_header(std::string_view json, std::size_t payload_bytes);

/// Writes samples as float32 to `out` (as many as `samples`). Returns how many of them no finite float32
/// can hold: NaN, infinite, or beyond 3.4e38; those are written as NaN. A frame with such samples says
/// nothing true about the run: the caller must treat it as a failure.
[[nodiscard]] std::size_t to_float32(std::span<const double> samples, std::span<float> out) noexcept;

/// The bytes of float32 samples as they go on the wire; a view, nothing is copied.
std::span<const std::byte> wire_bytes(std::span<const float> samples) noexcept;

/// Copies samples out of a payload, which may lie at any address. False (and nothing written) when the
/// payload is no whole number of samples.
[[nodiscard]] bool decode_samples(std::span<const std::byte> payload, std::vector<float>& samples);

}  // namespace hertzline::stream
