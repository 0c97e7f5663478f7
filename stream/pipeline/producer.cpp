#include "stream/pipeline/producer.hpp"

#include <algorithm>
#include <limits>

#include <pthread.h>

namespace hertzline::stream {

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
      ring_(slots, [&source] { return Block{.samples = source.make_block(), .demand = {}, .account = {}}; }),
      quarter_(std::max<std::size_t>(1, slots / 4)),
      discarded_to_(origin_) {}

Producer::~Producer() {
    stop();
}

std::vector<std::string> Producer::start(const ThreadOptions& options) {
    thread_ = std::thread([this] {
        pthread_setname_np(pthread_self(), simulating_thread_name);
        produce();
        finished_.store(true, std::memory_order_release);
        emptying_.wake();
    });
    return apply(options, thread_.native_handle());
}

void Producer::stop() noexcept {
    stopping_.store(true, std::memory_order_relaxed);
    filling_.wake();
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

void Producer::go() noexcept {
    going_.store(true, std::memory_order_release);
    filling_.wake();
}

void Producer::pop() noexcept {
    ring_.pop();
    filling_.wake_if([this] { return has_room(); });
}

void Producer::wait_for_block(Nanoseconds deadline) noexcept {
    emptying_.wait_until(deadline, [this] { return has_enough() || finished(); });
}

bool Producer::wait_for_go() noexcept {
    filling_.wait_until(never, [this] { return going_.load(std::memory_order_acquire) || stopping(); });
    return !stopping();
}

/// The slot for the next block; nullptr when the block must be discarded (its time has passed and there is no
/// room) or the stream is stopping.
Block* Producer::wait_for_slot(std::int64_t first, std::int64_t count) noexcept {
    if (Block* slot = ring_.try_claim()) {
        return slot;
    }
    Nanoseconds deadline = never;
    if (on_overrun_ == OnOverrun::drop) {
        const auto due_with = static_cast<std::uint64_t>(first + count - origin_);
        if (pacer_.lateness(MonotonicClock::now(), due_with) > Nanoseconds{0}) {
            return nullptr;
        }
        deadline = pacer_.due(due_with);
    }
    filling_.wait_until(deadline, [this] { return has_room() || stopping(); });
    return ring_.try_claim();
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
            discarded_to_.store(source_.next_sample(), std::memory_order_relaxed);
        } else {
            running = fill(*slot, count);
        }
        busy_ns_.store(busy().count() + (MonotonicClock::now() - begin).count(), std::memory_order_relaxed);
        if (slot != nullptr && running) {
            slot->seq = seq;
            slot->dropped = dropped;
            ring_.publish();
            emptying_.wake_if([this] { return has_enough(); });
        }
        ++seq;
    }
}

}  // namespace hertzline::stream
