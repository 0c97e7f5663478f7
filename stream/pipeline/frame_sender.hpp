#pragma once
// From a block's samples to frames on the wire.

#include <string>
#include <vector>

#include "stream/pipeline/producer.hpp"
#include "stream/pipeline/stream_monitor.hpp"
#include "stream/pipeline/topic_demand.hpp"
#include "stream/sources/sample_source.hpp"
#include "stream/wire/frame.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// Sends a tap's samples as a raw frame (samples alone) and as an np frame (header and samples). Keeps its
/// buffers from block to block.
class FrameSender {
public:
    /// @param run the run's id @param publisher outlives the sender
    FrameSender(Publisher& publisher, const StreamFormat& format, const std::string& run);

    /// Sends what is wanted of the block, and counts the frames.
    /// @throws std::runtime_error when a sample does not fit float32
    void send(const Block& block, const TopicDemand& demand, StreamMeters& meters);

private:
    void send_raw(Tap tap, StreamMeters& meters);
    void send_np(const Block& block, Tap tap, StreamMeters& meters);

    Publisher& publisher_;
    FrameHeader frame_;
    std::string header_;
    std::vector<float> payload_;  // of the tap that is being sent
};

}  // namespace hertzline::stream
