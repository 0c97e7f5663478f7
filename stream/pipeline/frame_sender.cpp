#include "stream/pipeline/frame_sender.hpp"

#include <span>
#include <stdexcept>

#include "stream/float32.hpp"
#include "stream/wire/frame_codec.hpp"

namespace hertzline::stream {

namespace {

std::span<const double> values_of(const Samples& samples, Tap tap) noexcept {
    switch (tap) {
        case Tap::v_out:
            return {samples.v_out.data(), samples.count};
        case Tap::v_last:
            return {samples.v_last.data(), samples.count};
        case Tap::v_plate:
            return {samples.v_plate.data(), samples.count};
        case Tap::v_chain:
            break;
    }
    return {samples.chain_v.data(), samples.count * samples.spheres};
}

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
        const std::span<const double> values = values_of(block.samples, tap);
        payload_.resize(values.size());
        if (to_float32(values, payload_) != 0) {
            throw std::runtime_error("a sample of " + std::string(names_of(tap).name) +
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
    add(meters.raw(tap), publisher_.send(names_of(tap).raw_topic, wire_bytes(payload_)));
}

void FrameSender::send_np(const Block& block, Tap tap, StreamMeters& meters) {
    const TapNames names = names_of(tap);
    frame_.stream = names.name;
    frame_.unit = names.unit;
    frame_.sample = static_cast<std::uint64_t>(block.samples.first);
    frame_.seq = block.seq;
    frame_.dropped = block.dropped;
    frame_.n = block.samples.count;
    frame_.channels = payload_.size() / block.samples.count;
    encode_header(frame_, header_);
    add(meters.np(tap), publisher_.send(names.np_topic, header_, wire_bytes(payload_)));
}

}  // namespace hertzline::stream
