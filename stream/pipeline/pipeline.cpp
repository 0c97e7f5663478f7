#include "stream/pipeline/pipeline.hpp"

#include <algorithm>
#include <stdexcept>

#include "stream/float32.hpp"
#include "stream/wire/frame_codec.hpp"

namespace hertzline::stream {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Nanoseconds meters_period = milliseconds(100);
constexpr Nanoseconds meta_period = milliseconds(1000);
/// Frames are let go in bursts this far apart: waking up for each of ten thousand frames a second costs more
/// than sending.
constexpr double release_period_s = 1e-3;
/// Subscribers that come together shall all get sample 0.
constexpr Nanoseconds gathering = milliseconds(200);
/// Flat out there is no rest between two blocks; looking for subscriptions takes a system call.
constexpr Nanoseconds subscriptions_period = microseconds(200);
constexpr Nanoseconds idle_nap = milliseconds(1);
constexpr Nanoseconds empty_ring_nap = microseconds(200);

constexpr double reserve_s = 0.05;                     // of wall time that the ring's samples last,
constexpr double max_ring_bytes = 64.0 * 1024 * 1024;  // unless that is more than this;
constexpr double cached_ring_bytes = 1024.0 * 1024;    // flat out nothing is held back: it stays in cache
constexpr double min_slots = 4;
constexpr double max_slots = 4096;

double slot_bytes(const StreamFormat& format) noexcept {
    return static_cast<double>(format.frame_samples) * 8 * (3 + static_cast<double>(format.spheres));
}

double slots_for(const StreamFormat& format, Pace pace) noexcept {
    const double frame_rate = format.sample_rate_hz / static_cast<double>(format.frame_samples);
    const double by_time = pace.is_flat_out() ? max_slots : reserve_s * pace.times() * frame_rate;
    const double by_memory = (pace.is_flat_out() ? cached_ring_bytes : max_ring_bytes) / slot_bytes(format);
    return std::clamp(std::min(by_time, by_memory), min_slots, max_slots);
}

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

double seconds(Nanoseconds time) {
    return std::chrono::duration<double>(time).count();
}

}  // namespace

Pipeline::Pipeline(StreamOptions plan, SampleSource& source, Publisher& publisher, RowBuilder* recorder)
    : plan_(std::move(plan)),
      source_(source),
      publisher_(publisher),
      recorder_(recorder),
      format_(source.format()),
      run_id_(plan_.run),
      pacer_(format_.sample_rate_hz, plan_.pace),
      producer_(source, pacer_, static_cast<std::size_t>(slots_for(format_, plan_.pace)), plan_.samples,
                plan_.pace.is_flat_out() ? OnOverrun::wait : plan_.on_overrun) {
    plan_.about["security"] = word(publisher.security());
    frame_.run = run_id_;
    frame_.fs = format_.sample_rate_hz;
    payload_.reserve(static_cast<std::size_t>(format_.frame_samples) * format_.spheres);
    meters_.samples = producer_.origin();
}

double Pipeline::ring_bytes(const StreamFormat& format, Pace pace) noexcept {
    return slots_for(format, pace) * slot_bytes(format);
}

PublisherOptions Pipeline::publisher_options(const StreamFormat& format) noexcept {
    constexpr double max_queued_bytes = 512.0 * 1024 * 1024;  // for one subscriber that does not keep up
    const double largest_frame = static_cast<double>(format.frame_samples) *
                                 static_cast<double>(std::max<std::size_t>(1, format.spheres)) *
                                 sizeof(float);
    PublisherOptions options;
    options.send_high_water_mark =
        static_cast<int>(std::clamp(max_queued_bytes / largest_frame, 16.0, 65536.0));
    return options;
}

void Pipeline::listen_for_subscriptions() {
    const std::size_t news = publisher_.poll_subscriptions();
    wanted_raw_ = wanted_np_ = TapSet();
    for (const Tap tap : format_.taps) {
        const TapNames names = names_of(tap);
        wanted_raw_ |= publisher_.wanted(names.raw_topic) ? TapSet(tap) : TapSet();
        wanted_np_ |= publisher_.wanted(names.np_topic) ? TapSet(tap) : TapSet();
    }
    const TapSet wanted = wanted_raw_ | wanted_np_;
    const std::uint32_t wish = producer_.want(wanted);
    for (const Tap tap : wanted - wanted_) {
        wanted_since_[static_cast<std::size_t>(tap)] = wish;
    }
    wanted_ = wanted;
    if (!wanted.empty() && first_subscription_ == Nanoseconds{0}) {
        first_subscription_ = MonotonicClock::now();
    }
    if (news > 0) {
        publisher_.send(meta_topic, meta_json(plan_, format_, run_id_));
    }
}

void Pipeline::start_when_ready(Nanoseconds now) {
    if (started_) {
        return;
    }
    const bool gathered = first_subscription_ != Nanoseconds{0} && now - first_subscription_ >= gathering;
    if (plan_.start == StreamStart::at_once || gathered) {
        started_ = true;
        start_time_ = now;
        pacer_.start(now);
        producer_.go();
    }
}

/// Waits until the block's last sample is due, rounded up to the release period. @returns how late it then
/// is.
Nanoseconds Pipeline::hold_until_due(const Block& block, const std::atomic<bool>& stop) {
    if (pacer_.flat_out()) {
        return Nanoseconds{0};
    }
    look_at_ring();
    const double samples_per_release = format_.sample_rate_hz * plan_.pace.times() * release_period_s;
    const auto grain = static_cast<std::uint64_t>(std::max(1.0, samples_per_release));
    const auto end =
        static_cast<std::uint64_t>(block.samples.first - producer_.origin()) + block.samples.count;
    const std::uint64_t deadline = (end + grain - 1) / grain * grain;
    MonotonicClock clock;
    wait_until_due(clock, pacer_, deadline, [&] {
        listen_for_subscriptions();
        report(MonotonicClock::now());
        return !stop.load(std::memory_order_relaxed);
    });
    return pacer_.lateness(MonotonicClock::now(), deadline);
}

void Pipeline::send_tap(const Block& block, Tap tap) {
    const TapNames names = names_of(tap);
    const bool raw = wanted_raw_.contains(tap);
    const bool np = wanted_np_.contains(tap);
    if (!raw && !np) {
        return;
    }
    const std::span<const double> values = values_of(block.samples, tap);
    payload_.resize(values.size());
    if (to_float32(values, payload_) != 0) {
        throw std::runtime_error("a sample of " + std::string(names.name) + " does not fit float32");
    }
    const auto add = [](TopicCount& count, bool sent) { ++(sent ? count.sent : count.dropped); };
    if (raw) {
        add(meters_.raw(tap), publisher_.send(names.raw_topic, wire_bytes(payload_)));
    }
    if (np) {
        frame_.stream = names.name;
        frame_.unit = names.unit;
        frame_.sample = static_cast<std::uint64_t>(block.samples.first);
        frame_.seq = block.seq;
        frame_.dropped = block.dropped;
        frame_.n = block.samples.count;
        frame_.channels = values.size() / block.samples.count;
        encode_header(frame_, header_);
        add(meters_.np(tap), publisher_.send(names.np_topic, header_, wire_bytes(payload_)));
    }
}

/// Blocks that were discarded before they had frames: one of each topic that somebody listens to.
void Pipeline::count_dropped(std::uint64_t dropped) {
    const auto more = static_cast<std::int64_t>(dropped - dropped_counted_);
    dropped_counted_ = dropped;
    meters_.dropped_frames += more;
    for (const Tap tap : wanted_raw_) {
        meters_.raw(tap).dropped += more;
    }
    for (const Tap tap : wanted_np_) {
        meters_.np(tap).dropped += more;
    }
}

void Pipeline::release(const Block& block) {
    if (recorder_ != nullptr) {
        recorder_->write(block.samples);
    }
    count_dropped(block.dropped);
    for (const Tap tap : block.wish.taps) {
        // An older block holds the tap for somebody who has left; others without it may follow.
        if (block.wish.number >= wanted_since_[static_cast<std::size_t>(tap)]) {
            send_tap(block, tap);
        }
    }
}

void Pipeline::count(const Block& block, Nanoseconds lateness) {
    ++meters_.frames;
    meters_.late_frames += lateness > late_after ? 1 : 0;
    meters_.largest_lateness_s = std::max(meters_.largest_lateness_s, seconds(lateness));
    meters_.samples = block.samples.first + static_cast<std::int64_t>(block.samples.count);
    meters_.simulated_s = static_cast<double>(meters_.samples - producer_.origin()) / format_.sample_rate_hz;
    meters_.account = block.account;
    meters_.energy_residual = block.energy_residual;
}

void Pipeline::look_at_ring() {
    const RingBuffer<Block>& ring = producer_.ring();
    meters_.ring_fill = static_cast<double>(ring.size()) / static_cast<double>(ring.capacity());
    meters_.ring_high_water = std::max(meters_.ring_high_water, meters_.ring_fill);
}

/// The load since the last time, and how long the stream has run.
void Pipeline::measure(Nanoseconds now) {
    const Nanoseconds busy = producer_.busy();
    const Nanoseconds since = std::max(measured_at_, start_time_);
    meters_.load =
        started_ && now > since ? std::min(1.0, seconds(busy - busy_then_) / seconds(now - since)) : 0;
    measured_at_ = now;
    busy_then_ = busy;
    meters_.wall_s = started_ ? seconds(now - start_time_) : 0;
}

/// Meters ten times, meta once a second.
void Pipeline::report(Nanoseconds now) {
    if (now >= next_meters_) {
        next_meters_ = now + meters_period;
        look_at_ring();
        measure(now);
        if (publisher_.wanted(meters_topic)) {
            producer_.want_residual();
            publisher_.send(meters_topic, meters_json(meters_, format_.taps, run_id_));
        }
        events_->progress(meters_);
    }
    if (now >= next_meta_) {
        next_meta_ = now + meta_period;
        if (publisher_.wanted(meta_topic)) {
            publisher_.send(meta_topic, meta_json(plan_, format_, run_id_));
        }
    }
}

void Pipeline::deliver(const std::atomic<bool>& stop) {
    RingBuffer<Block>& ring = producer_.ring();
    Nanoseconds listened{0};
    while (!stop.load(std::memory_order_relaxed)) {
        const Nanoseconds now = MonotonicClock::now();
        start_when_ready(now);
        report(now);
        const bool finished = producer_.finished();
        const Block* block = ring.try_front();
        if (block == nullptr) {
            if (finished) {
                return;
            }
            listen_for_subscriptions();
            MonotonicClock::sleep_until(now + (pacer_.flat_out() ? empty_ring_nap : idle_nap));
            continue;
        }
        const Nanoseconds lateness = hold_until_due(*block, stop);
        if (stop.load(std::memory_order_relaxed)) {
            return;
        }
        if (!pacer_.flat_out() || now - listened >= subscriptions_period) {
            listen_for_subscriptions();  // the last moment: who came while we slept gets meta before this
                                         // block
            listened = now;
        }
        release(*block);
        count(*block, lateness);
        ring.pop();
    }
}

StreamMeters Pipeline::run(const std::atomic<bool>& stop, const StreamEvents& events) {
    events_ = &events;
    publisher_.send(meta_topic, meta_json(plan_, format_, run_id_));
    for (const std::string& refused : producer_.start(plan_.thread)) {
        events.warn(refused);
    }
    deliver(stop);
    producer_.stop();
    count_dropped(producer_.dropped());
    measured_at_ = busy_then_ = Nanoseconds{0};  // the summary's load is that of the whole run
    measure(MonotonicClock::now());
    meters_.energy_residual = source_.energy_residual();
    if (!source_.failure().empty()) {
        throw std::runtime_error(source_.failure());
    }
    publisher_.send(end_topic, events.summary(meters_));
    return meters_;
}

}  // namespace hertzline::stream
