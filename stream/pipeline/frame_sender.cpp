#include "stream/pipeline/frame_sender.hpp"

#include <span>
#include <stdexcept>
#include <utility>

#include "recordings/float32.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::stream {

namespace {

void add(TopicCount& count, bool sent) noexcept {
    ++(sent ? count.sent : count.dropped);
}

/// The samples of a tap as float32 in a message.
zmq::message_t payload_of(Publisher& publisher, const Block& block, Tap tap) {
    const std::span<const double> values = block.samples()[tap];
    return publisher.payload(values.size() * sizeof(float), [&](void* bytes) {
        if (recordings::to_float32(values, {static_cast<float*>(bytes), values.size()}) != 0) {
            throw std::runtime_error("a sample of " + std::string(row_of(tap).name) +
                                     " does not fit float32");
        }
    });
}

/// Another handle of the same bytes.
zmq::message_t shared(zmq::message_t& payload) {
    zmq::message_t other;
    other.copy(payload);
    return other;
}

}  // namespace

FrameSender::FrameSender(Publisher& publisher, const StreamFormat& format, const std::string& run)
    : publisher_(publisher) {
    frame_.run = run;
    frame_.fs = format.sample_rate_hz;
    frame_.latency_samples = format.latency_samples;
}

void FrameSender::send(const Block& block, const TopicDemand& demand, StreamMeters& meters) {
    const TapForms asked = demand.asked_of(block);
    const TapForms sent = demand.sent_of(block);
    for (const Tap tap : sent.all()) {
        zmq::message_t payload = payload_of(publisher_, block, tap);
        if (sent.raw.contains(tap)) {
            add(meters.raw(tap), publisher_.send_frame(topics_of(tap).raw, shared(payload)));
        }
        if (sent.np.contains(tap)) {
            describe(block, tap, meters.np(tap));
            add(meters.np(tap), publisher_.send_frame(topics_of(tap).np, header_, std::move(payload)));
        }
    }
    for (const Tap tap : asked.raw - sent.raw) {
        add(meters.raw(tap), false);
    }
    for (const Tap tap : asked.np - sent.np) {
        add(meters.np(tap), false);
    }
}

/// Writes the header of the tap's frame.
void FrameSender::describe(const Block& block, Tap tap, const TopicCount& count) {
    const TapRow& row = row_of(tap);
    frame_.stream = row.name;
    frame_.unit = row.unit;
    frame_.sample = static_cast<std::uint64_t>(block.samples().first);
    frame_.epoch = static_cast<std::uint64_t>(block.epoch.number);
    const BurstPlace place = block.epoch.at(frame_.fs, block.samples().first);
    frame_.burst = static_cast<std::uint64_t>(place.burst);
    frame_.burst_sample = static_cast<std::uint64_t>(place.sample);
    frame_.seq = block.seq;
    frame_.dropped = static_cast<std::uint64_t>(count.dropped);
    frame_.n = block.samples().count;
    frame_.channels = block.samples()[tap].size() / block.samples().count;
    encode_header(frame_, header_);
}

}  // namespace hertzline::stream
