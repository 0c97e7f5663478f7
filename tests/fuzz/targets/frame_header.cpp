// A frame's header as a peer may send it: the first line is the size of the samples that follow it in bytes,
// the rest the header.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "stream/wire/frame_codec.hpp"
#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

using namespace stream;

namespace {

constexpr std::size_t longest_message = 500;

void claim_sound(const FrameHeader& header, std::size_t payload_bytes) {
    claim(std::isfinite(header.fs) && header.fs > 0, "a rate is positive");
    claim(std::isfinite(header.t()), "a time is finite");
    claim(header.n >= 1 && header.channels >= 1, "a frame holds samples");
    claim(header.payload_bytes() == payload_bytes, "the shape fills the samples' bytes");
}

void claim_round_trip(const FrameHeader& header, std::size_t payload_bytes) {
    std::string json;
    encode_header(header, json);
    const auto again = decode_header(json, payload_bytes);
    claim(again.has_value(), "a written header reads back", json);
    claim(*again == header, "a written header reads back the same", json);
}

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    using namespace hertzline::stream;
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    const std::size_t line_end = std::min(input.find('\n'), size);
    std::size_t payload_bytes = 0;
    std::from_chars(input.data(), input.data() + line_end, payload_bytes);
    const auto header = decode_header(input.substr(std::min(line_end + 1, size)), payload_bytes);
    if (header) {
        fuzz::claim_sound(*header, payload_bytes);
        fuzz::claim_round_trip(*header, payload_bytes);
    } else {
        fuzz::claim_message(header.error(), fuzz::longest_message);
    }
    return 0;
}
