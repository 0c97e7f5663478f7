#include "stream/pipeline/stream_monitor.hpp"

#include <algorithm>
#include <chrono>

namespace hertzline::stream {

StreamMonitor::StreamMonitor(std::int64_t origin, double sample_rate_hz) noexcept
    : origin_(origin), sample_rate_hz_(sample_rate_hz) {
    meters_.samples = origin;
}

void StreamMonitor::count(const Block& block, Nanoseconds lateness) noexcept {
    ++meters_.frames;
    meters_.late_frames += lateness > late_after ? 1 : 0;
    meters_.largest_lateness_s = std::max(meters_.largest_lateness_s, seconds(lateness));
    pass(block.samples().first + static_cast<std::int64_t>(block.samples().count));
    meters_.account = block.account;
    meters_.motion = block.motion;
}

void StreamMonitor::wait(Nanoseconds lateness) noexcept {
    meters_.largest_lateness_s = std::max(meters_.largest_lateness_s, seconds(lateness));
}

void StreamMonitor::pass(std::int64_t sample) noexcept {
    meters_.samples = std::max(meters_.samples, sample);
    meters_.simulated_s = static_cast<double>(meters_.samples - origin_) / sample_rate_hz_;
}

void StreamMonitor::count_dropped(std::uint64_t dropped, const TopicDemand& demand) noexcept {
    const auto more = static_cast<std::int64_t>(dropped - dropped_counted_);
    dropped_counted_ = dropped;
    meters_.dropped_frames += more;
    for (const Tap tap : demand.asked().raw) {
        meters_.raw(tap).dropped += more;
    }
    for (const Tap tap : demand.asked().np) {
        meters_.np(tap).dropped += more;
    }
}

void StreamMonitor::look_at(const RingBuffer<Block>& ring) noexcept {
    meters_.ring_fill = static_cast<double>(ring.size()) / static_cast<double>(ring.capacity());
    meters_.ring_high_water = std::max(meters_.ring_high_water, meters_.ring_fill);
}

void StreamMonitor::measure(Nanoseconds now, Nanoseconds start, Nanoseconds busy) noexcept {
    const Nanoseconds since = std::max(measured_at_, start);
    meters_.load = now > since ? std::min(1.0, seconds(busy - busy_then_) / seconds(now - since)) : 0;
    measured_at_ = now;
    busy_then_ = busy;
    meters_.wall_s = std::max(0.0, seconds(now - start));  // it begins a little later
}

void StreamMonitor::measure_all(Nanoseconds now, Nanoseconds start, Nanoseconds busy) noexcept {
    measured_at_ = busy_then_ = Nanoseconds{0};
    measure(now, start, busy);
}

}  // namespace hertzline::stream
