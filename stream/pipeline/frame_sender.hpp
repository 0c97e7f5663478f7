#pragma once
// From a block's samples to frames on the wire.

#include <string>

#include <zmq.hpp>

#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/pipeline/stream_monitor.hpp"
#include "stream/pipeline/topic_demand.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// Sends a tap's samples as a raw frame (samples alone) and as an np frame (header and samples). They are written
/// as float32 into the message that ZeroMQ sends, which both frames share.
class FrameSender {
public:
    /// @param run the run's id @param publisher outlives the sender
    FrameSender(Publisher& publisher, const StreamFormat& format, const std::string& run);

    /// Sends the demanded taps of the block, and counts the frames: also those that are asked for and not made.
    /// @throws std::runtime_error when a sample does not fit float32
    void send(const Block& block, const TopicDemand& demand, StreamMeters& meters);

private:
    void describe(const Block& block, Tap tap, const TopicCount& count);

    Publisher& publisher_;
    FrameHeader frame_;
    std::string header_;
};

}  // namespace hertzline::stream
