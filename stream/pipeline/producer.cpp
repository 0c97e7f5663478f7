#include "stream/pipeline/producer.hpp"

#include <algorithm>
#include <limits>

#include <pthread.h>

namespace hertzline::stream {

namespace {

constexpr Nanoseconds before_go_nap = std::chrono::milliseconds(1);
constexpr Nanoseconds full_ring_nap = std::chrono::microseconds(200);

}  // namespace

Producer::Producer(SampleSource& source, const Pacer& pacer, std::size_t slots,
                   std::optional<std::int64_t> samples, OnOverrun on_overrun)
    : source_(source),
      pacer_(pacer),
      frame_samples_(source.format().frame_samples),
      origin_(source.next_sample()),
      end_(samples && *samples < std::numeric_limits<std::int64_t>::max() - origin_
               ? origin_ + *samples
               : std::numeric_limits<std::int64_t>::max()),
      on_overrun_(on_overrun),
      ring_(slots, [&source] { return Block{.samples = source.make_block(), .demand = {}, .account = {}}; }) {
}

Producer::~Producer() {
    stop();
}

std::vector<std::string> Producer::start(const ThreadOptions& options) {
    thread_ = std::thread([this] {
        pthread_setname_np(pthread_self(), simulating_thread_name);
        produce();
        finished_.store(true, std::memory_order_release);
    });
    return apply(options, thread_.native_handle());
}

void Producer::stop() noexcept {
    stopping_.store(true, std::memory_order_relaxed);
    source_.interrupt();
    if (thread_.joinable()) {
        thread_.join();
    }
}

std::uint32_t Producer::want(TapSet taps) noexcept {
    Demand demand = demand_.load(std::memory_order_relaxed);
    if (taps != demand.taps) {
        demand = {taps, demand.generation + 1};
        demand_.store(demand, std::memory_order_relaxed);
    }
    return demand.generation;
}

bool Producer::wait_for_go() const noexcept {
    while (!going_.load(std::memory_order_acquire)) {
        if (stopping()) {
            return false;
        }
        MonotonicClock::sleep_until(MonotonicClock::now() + before_go_nap);
    }
    return true;
}

/// The slot for the next block; nullptr when the block must be discarded (its time has passed and there is no
/// room) or the stream is stopping.
Block* Producer::wait_for_slot(std::int64_t first, std::int64_t count) noexcept {
    const auto due_with = static_cast<std::uint64_t>(first + count - origin_);
    while (!stopping()) {
        if (Block* slot = ring_.try_claim()) {
            return slot;
        }
        if (on_overrun_ == OnOverrun::drop &&
            pacer_.lateness(MonotonicClock::now(), due_with) > Nanoseconds{0}) {
            return nullptr;
        }
        MonotonicClock::sleep_until(MonotonicClock::now() + full_ring_nap);
    }
    return nullptr;
}

bool Producer::fill(Block& block, std::int64_t count) noexcept {
    block.demand = demand_.load(std::memory_order_relaxed);
    if (!source_.read(block.samples, static_cast<std::size_t>(count), block.demand.taps)) {
        return false;
    }
    block.account = source_.account();
    if (residual_wanted_.exchange(false, std::memory_order_relaxed)) {
        last_residual_ = source_.energy_residual();
    }
    block.energy_residual = last_residual_;
    return true;
}

void Producer::produce() noexcept {
    std::uint64_t seq = 0;
    std::uint64_t dropped = 0;
    bool running = wait_for_go();
    while (running && source_.next_sample() < end_) {
        const std::int64_t first = source_.next_sample();
        const std::int64_t count = std::min(frame_samples_, end_ - first);
        Block* slot = wait_for_slot(first, count);
        if (stopping()) {
            return;
        }
        const Nanoseconds begin = MonotonicClock::now();
        if (slot == nullptr) {
            dropped_.store(++dropped, std::memory_order_relaxed);
            running = source_.skip(count);
        } else {
            running = fill(*slot, count);
        }
        busy_ns_.store(busy().count() + (MonotonicClock::now() - begin).count(), std::memory_order_relaxed);
        if (slot != nullptr && running) {
            slot->seq = seq;
            slot->dropped = dropped;
            ring_.publish();
        }
        ++seq;
    }
}

}  // namespace hertzline::stream
