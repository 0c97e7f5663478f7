#pragma once
// The only place that knows the JSON header of the .../np topics; its samples follow as float32. Writing a header
// happens per frame and topic, some 40 000 times a second: straight into a buffer that the caller keeps, no document
// tree. Reading is for listeners, which do not trust received bytes.

#include <cstddef>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "stream/wire/frame.hpp"

namespace hertzline::stream {

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
