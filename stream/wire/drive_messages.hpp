#pragma once
// The messages that drive a horn: float32 samples, alone, behind a topic, or as a frame of a stream of ours, whose numbers tell what was lost.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>
#include <zmq.hpp>

#include "stream/wire/continuity.hpp"
#include "stream/wire/frame_codec.hpp"

namespace hertzline::stream {

/// For one thread. Messages come from outside and are not trusted.
class DriveMessages {
public:
    struct Limits {
        double sample_rate_hz = 0;    ///< that frames must have
        double largest = 0;           ///< size of a sample
        std::size_t longest_gap = 0;  ///< samples in whose place zeros may be taken
        std::string unit = {};        ///< that frames must have; empty: any
        bool topics = true;           ///< whether samples may stand behind a topic
    };

    /// A message that was read.
    struct Read {
        std::uint64_t lost = 0;  ///< samples before it
        std::size_t zeros = 0;   ///< in their place: all of them, unless they are too many
    };

    /// Longest message in parts: topic, header, samples.
    static constexpr std::size_t most_parts = 3;

    explicit DriveMessages(Limits limits) : limits_(std::move(limits)) {}

    /// Reads a message: its samples are in samples() until the next one. Returns its fault if it is none; then it changes nothing.
    tl::expected<Read, std::string> read(std::span<const zmq::message_t> parts);
    std::span<const float> samples() const noexcept { return samples_; }

private:
    std::string fault_of(std::span<const zmq::message_t> parts);
    tl::expected<Read, std::string> place(const FrameHeader& frame);

    Limits limits_;
    ContinuityCheck continuity_;
    std::string stream_;  ///< of the first frame
    /// Of a frame that was too far ahead: if the next one follows it, so does the stream.
    std::optional<FrameHeader> ahead_;
    std::vector<float> samples_;
};

}  // namespace hertzline::stream
