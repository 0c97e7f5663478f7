#include "stream/pipeline/frame_sender.hpp"

#include <span>
#include <stdexcept>

#include "stream/float32.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::stream {

namespace {

void add(TopicCount& count, bool sent) noexcept {
    ++(sent ? count.sent : count.dropped);
}

}  // namespace

FrameSender::FrameSender(Publisher& publisher, const StreamFormat& format, const std::string& run)
    : publisher_(publisher) {
    frame_.run = run;
    frame_.fs = format.sample_rate_hz;
    payload_.reserve(static_cast<std::size_t>(format.frame_samples) * format.spheres);
}

void FrameSender::send(const Block& block, const TopicDemand& demand, StreamMeters& meters) {
    for (const Tap tap : demand.met_by(block.demand)) {
        const std::span<const double> values = block.samples[tap];
        payload_.resize(values.size());
        if (to_float32(values, payload_) != 0) {
            throw std::runtime_error("a sample of " + std::string(row_of(tap).name) +
                                     " does not fit float32");
        }
        if (demand.raw().contains(tap)) {
            send_raw(tap, meters);
        }
        if (demand.np().contains(tap)) {
            send_np(block, tap, meters);
        }
    }
}

void FrameSender::send_raw(Tap tap, StreamMeters& meters) {
    add(meters.raw(tap), publisher_.send(topics_of(tap).raw, wire_bytes(payload_)));
}

void FrameSender::send_np(const Block& block, Tap tap, StreamMeters& meters) {
    const TapRow& row = row_of(tap);
    frame_.stream = row.name;
    frame_.unit = row.unit;
    frame_.sample = static_cast<std::uint64_t>(block.samples.first);
    frame_.seq = block.seq;
    frame_.dropped = block.dropped;
    frame_.n = block.samples.count;
    frame_.channels = payload_.size() / block.samples.count;
    encode_header(frame_, header_);
    add(meters.np(tap), publisher_.send(topics_of(tap).np, header_, wire_bytes(payload_)));
}

}  // namespace hertzline::stream
