#include "stream/pipeline/producer.hpp"

#include <algorithm>
#include <limits>

#include <pthread.h>

namespace hertzline::stream {

Producer::Producer(SampleSource& source, const Pacer& pacer, RingSize size,
                   std::optional<std::int64_t> samples, OnOverrun on_overrun)
    : source_(source),
      pacer_(pacer),
      frame_samples_(source.format().frame_samples),
      origin_(source.next_sample()),
      end_(samples && *samples < std::numeric_limits<std::int64_t>::max() - origin_
               ? origin_ + *samples
               : std::numeric_limits<std::int64_t>::max()),
      on_overrun_(on_overrun),
      refill_(size.refill),
      ring_(size.blocks,
            [&source, small = source.format().taps - source.format().of_chain()] {
                return Block{.small = source.make_block(small),
                             .demand = {},
                             .missing = {},
                             .account = {},
                             .motion = {},
                             .epoch = {}};
            }),
      enough_(pacer.flat_out() && !source.format().latency_samples ? quarter_of(size.blocks) : 1),
      chain_taps_(source.format().of_chain()),
      discarded_to_(origin_) {
    for (std::size_t i = 0; i < size.chain_blocks; ++i) {
        chain_blocks_.push_back(source.make_block(source.format().taps));
    }
}

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
    source_.interrupt();
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
        filling_.wake_if(
            [this] { return has_room(); });  // there may be less room for one kind than for the other
    }
    return demand.generation;
}

void Producer::go() noexcept {
    going_.store(true, std::memory_order_release);
    filling_.wake();
}

std::size_t Producer::free_chain_blocks() const noexcept {
    const std::uint64_t returned = chain_blocks_returned_.load(std::memory_order_acquire);
    return chain_blocks_.size() - (chain_blocks_filled_.load(std::memory_order_acquire) - returned);
}

/// Whether there is room for the next blocks, of the kind demanded now.
bool Producer::has_room() const noexcept {
    return ring_.capacity() - ring_.size() >= refill_of(ring_.capacity()) &&
           (!makes_chain(demand_.load(std::memory_order_relaxed).taps) ||
            free_chain_blocks() >= refill_of(chain_blocks_.size()));
}

void Producer::pop() noexcept {
    if (ring_.try_front()->chain != nullptr) {
        chain_blocks_returned_.fetch_add(1, std::memory_order_release);
    }
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

/// Returns a slot with room for the taps demanded now, or nullptr.
Block* Producer::try_claim() noexcept {
    Block* const block = ring_.try_claim();
    if (block == nullptr) {
        return nullptr;
    }
    block->demand = demand_.load(std::memory_order_relaxed);
    block->chain = nullptr;
    if (makes_chain(block->demand.taps)) {
        if (free_chain_blocks() == 0) {
            return nullptr;
        }
        const std::uint64_t filled = chain_blocks_filled_.load(std::memory_order_relaxed);
        block->chain = &chain_blocks_[filled % chain_blocks_.size()];
    }
    return block;
}

/// The slot for the next block; nullptr when the block must be discarded (its time has passed and there is no
/// room) or the stream is stopping.
Block* Producer::wait_for_slot(std::int64_t first, std::int64_t count) noexcept {
    if (Block* slot = try_claim()) {
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
    while (!stopping() && MonotonicClock::now() < deadline) {
        filling_.wait_until(deadline, [this] { return has_room() || stopping(); });
        if (Block* slot = try_claim()) {  // not where more is demanded than there was room for
            return slot;
        }
    }
    return nullptr;
}

bool Producer::fill(Block& block, std::int64_t count) noexcept {
    if (!source_.read(block.samples(), static_cast<std::size_t>(count), block.demand.taps)) {
        return false;
    }
    block.missing = block.demand.taps - block.samples().holds;
    block.account = source_.account();
    block.epoch = source_.epoch();
    const bool another_epoch = block.epoch.number != epoch_seen_;
    epoch_seen_ = block.epoch.number;
    if (motion_wanted_.exchange(false, std::memory_order_relaxed) || another_epoch) {
        last_motion_ = source_.motion();
    }
    block.motion = last_motion_;
    return true;
}

void Producer::produce() noexcept {
    std::uint64_t seq = 0;
    std::uint64_t dropped = 0;
    bool running = wait_for_go();
    while (running && source_.next_sample() < end_) {
        const std::int64_t first = source_.next_sample();
        const std::int64_t count = std::min({frame_samples_, end_ - first, source_.samples_to_change()});
        Block* slot = wait_for_slot(first, count);
        if (stopping() || !source_.wait_for(count)) {
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
            if (slot->chain != nullptr) {
                chain_blocks_filled_.fetch_add(1, std::memory_order_release);
            }
            ring_.publish();
            emptying_.wake_if([this] { return has_enough(); });
        }
        ++seq;
    }
}

}  // namespace hertzline::stream
