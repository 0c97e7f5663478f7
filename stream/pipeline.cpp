#include "stream/pipeline.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <thread>

#include <pthread.h>

#include "stream/frame_codec.hpp"

namespace hertzline {

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
constexpr Nanoseconds idle_nap = milliseconds(1);
constexpr Nanoseconds full_ring_nap = microseconds(200);

constexpr double reserve_s = 0.05;                      // of wall time that the ring's samples last,
constexpr double most_ring_bytes = 64.0 * 1024 * 1024;  // unless that is more than this
constexpr double fewest_slots = 4;
constexpr double most_slots = 4096;

constexpr Wish everything{.outputs = true, .chain_velocities = true, .chain_displacements = false};

double slot_bytes(const Scene& scene) noexcept {
    return static_cast<double>(scene.output.frame_samples) * 8 *
           (3 + static_cast<double>(scene.chain.spheres));
}

double slots_for(const Scene& scene, Pace pace) noexcept {
    const double pace_factor = pace.is_flat_out() ? 1 : pace.times();
    const double frame_rate = scene.output.sample_rate_hz / static_cast<double>(scene.output.frame_samples);
    const double by_time = reserve_s * pace_factor * frame_rate;
    return std::clamp(std::min(by_time, most_ring_bytes / slot_bytes(scene)), fewest_slots, most_slots);
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

}  // namespace

Pipeline::Pipeline(StreamPlan plan, Publisher& publisher, Recorder* recorder)
    : plan_(std::move(plan)),
      publisher_(publisher),
      recorder_(recorder),
      run_id_(plan_.run),
      simulation_(plan_.scene, everything),
      pacer_(plan_.scene.output.sample_rate_hz, plan_.pace),
      possible_(taps_of(plan_.scene.end.kind)),
      ring_(static_cast<std::size_t>(slots_for(plan_.scene, plan_.pace)), [this] {
          const auto capacity = static_cast<std::size_t>(plan_.scene.output.frame_samples);
          return Block{.samples = Samples(simulation_.chain(), capacity, everything), .taps = {}};
      }) {
    frame_.run = run_id_;
    frame_.fs = plan_.scene.output.sample_rate_hz;
    payload_.reserve(static_cast<std::size_t>(plan_.scene.output.frame_samples * plan_.scene.chain.spheres));
}

double Pipeline::memory_bytes(const Scene& scene, Pace pace) noexcept {
    return slots_for(scene, pace) * slot_bytes(scene) + Simulation::memory_bytes(scene, everything);
}

PublisherOptions Pipeline::publisher_options(const Scene& scene) noexcept {
    constexpr double most_queued_bytes = 512.0 * 1024 * 1024;  // for one subscriber that does not keep up
    const auto largest_frame =
        static_cast<double>(scene.output.frame_samples * scene.chain.spheres) * sizeof(float);
    PublisherOptions options;
    options.send_high_water_mark =
        static_cast<int>(std::clamp(most_queued_bytes / largest_frame, 16.0, 65536.0));
    return options;
}

Wish Pipeline::wish_for(TapSet taps) const noexcept {
    const bool outputs = !(taps - TapSet(Tap::v_chain)).empty() || recorder_ != nullptr;
    return {
        .outputs = outputs, .chain_velocities = taps.contains(Tap::v_chain), .chain_displacements = false};
}

// ---------------------------------------------------------------------------------------------- simulating
// thread

bool Pipeline::wait_for_start() noexcept {
    while (!started_.load(std::memory_order_acquire)) {
        if (stopping_.load(std::memory_order_relaxed)) {
            return false;
        }
        MonotonicClock::sleep_until(MonotonicClock::now() + idle_nap);
    }
    return true;
}

/// The slot for the next block; nullptr when it must be discarded (its time has passed and there is no room)
/// or the stream is stopping.
Block* Pipeline::wait_for_slot(std::int64_t first, std::int64_t count) noexcept {
    const auto due_with = static_cast<std::uint64_t>(first + count);
    while (!stopping_.load(std::memory_order_relaxed)) {
        if (Block* slot = ring_.try_claim()) {
            return slot;
        }
        const bool may_discard = recorder_ == nullptr && !pacer_.flat_out();
        if (may_discard && pacer_.lateness(MonotonicClock::now(), due_with) > Nanoseconds{0}) {
            return nullptr;
        }
        MonotonicClock::sleep_until(MonotonicClock::now() + full_ring_nap);
    }
    return nullptr;
}

void Pipeline::simulate() noexcept {
    // Nothing here allocates, locks or sends.
    pthread_setname_np(pthread_self(), simulating_thread_name);
    const std::int64_t frame = plan_.scene.output.frame_samples;
    const std::int64_t total = plan_.samples.value_or(std::numeric_limits<std::int64_t>::max());
    std::int64_t busy_ns = 0;
    bool running = wait_for_start();
    while (running && simulation_.next_sample() < total && !stopping_.load(std::memory_order_relaxed)) {
        const std::int64_t first = simulation_.next_sample();
        const std::int64_t count = std::min(frame, total - first);
        Block* slot = wait_for_slot(first, count);
        if (slot == nullptr && stopping_.load(std::memory_order_relaxed)) {
            break;
        }
        const Nanoseconds begin = MonotonicClock::now();
        if (slot == nullptr) {
            dropped_.fetch_add(1, std::memory_order_relaxed);
            running = simulation_.skip(count) == Status::running;
            busy_ns += (MonotonicClock::now() - begin).count();
            continue;
        }
        const TapSet taps = wanted_.load(std::memory_order_relaxed);
        running = simulation_.advance(slot->samples, static_cast<std::size_t>(count), wish_for(taps)) ==
                  Status::running;
        if (!running) {
            break;
        }
        slot->taps = taps;
        slot->dropped = dropped_.load(std::memory_order_relaxed);
        slot->contact_events = simulation_.contact_events();
        slot->steps = simulation_.steps();
        if (meters_wanted_.exchange(false, std::memory_order_relaxed)) {
            last_residual_ = simulation_.energy_residual();
        }
        slot->energy_residual = last_residual_;
        busy_ns += (MonotonicClock::now() - begin).count();
        slot->busy_ns = busy_ns;
        ring_.publish();
    }
    finished_.store(true, std::memory_order_release);
}

// ------------------------------------------------------------------------------------------------- sending
// thread

void Pipeline::listen_for_subscriptions() {
    const std::size_t news = publisher_.poll_subscriptions();
    TapSet wanted;
    for (const Tap tap : possible_) {
        const TapNames names = names_of(tap);
        if (publisher_.wanted(names.raw_topic) || publisher_.wanted(names.np_topic)) {
            wanted |= tap;
        }
    }
    wanted_.store(wanted, std::memory_order_relaxed);
    if (!wanted.empty() && first_subscription_ == Nanoseconds{0}) {
        first_subscription_ = MonotonicClock::now();
    }
    if (news > 0) {
        publisher_.send(meta_topic, meta_json(plan_));
    }
}

void Pipeline::start_when_ready() {
    if (started_.load(std::memory_order_relaxed)) {
        return;
    }
    const Nanoseconds now = MonotonicClock::now();
    const bool gathered = first_subscription_ != Nanoseconds{0} && now - first_subscription_ >= gathering;
    if (plan_.start == StreamStart::at_once || gathered) {
        start_time_ = now;
        pacer_.start(now);
        started_.store(true, std::memory_order_release);
    }
}

/// Waits until the block's last sample is due, rounded up to the release period. @returns how late it is,
/// negative when there was time left.
Nanoseconds Pipeline::hold_until_due(const Block& block, const std::atomic<bool>& stop) {
    const double samples_per_release =
        plan_.scene.output.sample_rate_hz * plan_.pace.times() * release_period_s;
    const auto grain = static_cast<std::uint64_t>(std::max(1.0, samples_per_release));
    const auto end = static_cast<std::uint64_t>(block.samples.first) + block.samples.count;
    const std::uint64_t deadline = (end + grain - 1) / grain * grain;
    MonotonicClock clock;
    return wait_until_due(clock, pacer_, deadline, [&] {
        listen_for_subscriptions();
        report();
        return !stop.load(std::memory_order_relaxed);
    });
}

void Pipeline::send_tap(const Block& block, Tap tap) {
    const TapNames names = names_of(tap);
    const bool raw = publisher_.wanted(names.raw_topic);
    const bool np = publisher_.wanted(names.np_topic);
    if (!raw && !np) {
        return;
    }
    const std::span<const double> values = values_of(block.samples, tap);
    payload_.resize(values.size());
    if (to_float32(values, payload_) != 0) {
        throw std::runtime_error("a sample of " + std::string(names.name) + " does not fit float32");
    }
    if (raw) {
        publisher_.send(names.raw_topic, wire_bytes(payload_));
    }
    if (np) {
        frame_.stream = names.name;
        frame_.unit = names.unit;
        frame_.sample = static_cast<std::uint64_t>(block.samples.first);
        frame_.seq = frame_.sample / static_cast<std::uint64_t>(plan_.scene.output.frame_samples);
        frame_.dropped = block.dropped;
        frame_.n = block.samples.count;
        frame_.channels = values.size() / block.samples.count;
        encode_header(frame_, header_);
        publisher_.send(names.np_topic, header_, wire_bytes(payload_));
    }
}

void Pipeline::release(const Block& block) {
    if (recorder_ != nullptr) {
        recorder_->write(block.samples);
    }
    for (const Tap tap : block.taps) {
        send_tap(block, tap);
    }
    ++meters_.frames;
    meters_.samples = block.samples.first + static_cast<std::int64_t>(block.samples.count);
    meters_.simulated_s = static_cast<double>(meters_.samples) / plan_.scene.output.sample_rate_hz;
    meters_.contact_events = block.contact_events;
    meters_.steps = block.steps;
    meters_.energy_residual = block.energy_residual;
    const auto wall_ns = static_cast<double>((MonotonicClock::now() - start_time_).count());
    meters_.load = wall_ns > 0 ? std::min(1.0, static_cast<double>(block.busy_ns) / wall_ns) : 0;
}

/// Meters ten times, meta once a second.
void Pipeline::report() {
    const Nanoseconds now = MonotonicClock::now();
    if (now >= next_meters_) {
        next_meters_ = now + meters_period;
        meters_.dropped_frames = static_cast<std::int64_t>(dropped_.load(std::memory_order_relaxed));
        meters_.ring_fill = static_cast<double>(ring_.size()) / static_cast<double>(ring_.capacity());
        meters_.wall_s = started_ ? std::chrono::duration<double>(now - start_time_).count() : 0;
        if (publisher_.wanted(meters_topic)) {
            meters_wanted_.store(true, std::memory_order_relaxed);
            publisher_.send(meters_topic, meters_json(meters_, run_id_));
        }
        progress_(meters_);
    }
    if (now >= next_meta_) {
        next_meta_ = now + meta_period;
        if (publisher_.wanted(meta_topic)) {
            publisher_.send(meta_topic, meta_json(plan_));
        }
    }
}

void Pipeline::deliver(const std::atomic<bool>& stop) {
    while (!stop.load(std::memory_order_relaxed)) {
        listen_for_subscriptions();
        start_when_ready();
        report();
        const bool finished = finished_.load(std::memory_order_acquire);
        const Block* block = ring_.try_front();
        if (block == nullptr) {
            if (finished) {
                return;
            }
            MonotonicClock::sleep_until(MonotonicClock::now() +
                                        (pacer_.flat_out() ? full_ring_nap : idle_nap));
            continue;
        }
        if (hold_until_due(*block, stop) > late_after) {
            ++meters_.late_frames;
        }
        if (stop.load(std::memory_order_relaxed)) {
            return;
        }
        release(*block);
        ring_.pop();
    }
}

StreamMeters Pipeline::run(const std::atomic<bool>& stop,
                           const std::function<void(const StreamMeters&)>& progress,
                           const std::function<std::string(const StreamMeters&)>& summary) {
    progress_ = progress;
    publisher_.send(meta_topic, meta_json(plan_));
    {
        struct StopAtExit {
            std::atomic<bool>& flag;
            ~StopAtExit() { flag.store(true, std::memory_order_relaxed); }
        };
        std::jthread simulating([this] { simulate(); });
        const StopAtExit stop_at_exit{stopping_};  // before the thread is joined, whatever happens
        deliver(stop);
    }
    const Nanoseconds now = MonotonicClock::now();
    meters_.wall_s = started_ ? std::chrono::duration<double>(now - start_time_).count() : 0;
    meters_.dropped_frames = static_cast<std::int64_t>(dropped_.load());
    meters_.energy_residual = simulation_.energy_residual();
    if (!simulation_.failure().empty()) {
        throw std::runtime_error(simulation_.failure());
    }
    publisher_.send(end_topic, summary(meters_));
    return meters_;
}

}  // namespace hertzline
