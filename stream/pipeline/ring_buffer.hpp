#pragma once
// A bounded queue between exactly one writing and one reading thread, without locks. The slots are constructed once
// and filled and read in place, so that samples are never copied on their way and nothing is allocated.
//
//     writer                                  reader
//     if (Slot* slot = ring.try_claim()) {    if (Slot* slot = ring.try_front()) {
//         fill(*slot);                            use(*slot);
//         ring.publish();                         ring.pop();
//     }                                       }
//
// Two counters, each written by one side only: slots published, slots popped. Full is a difference of the
// capacity, empty a difference of zero, so no slot is sacrificed to distinguish them. Memory orders:
//   published   release by publish(), acquire by try_front(): a thread that sees the count sees the slot's content.
//   popped      release by pop(), acquire by try_claim(): the writer may overwrite a slot only after the
//               reader's last read of it.
//   a side's own counter is read relaxed: no other thread writes it.
// Each side caches the other's counter and reads it again only when the cached value means full or empty: otherwise
// every call would move the other core's cache line over here. A counter has its line to itself: a side that waits
// reads the other's again and again, and each write to that line would move it twice.

#include <algorithm>
#include <atomic>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace hertzline::stream {

/// A bounded queue of slots between one writing and one reading thread.
template <class Slot>
class RingBuffer {
public:
    /// A ring of `capacity` >= 1 slots, each made by one call of make_slot(). @throws std::invalid_argument
    /// for capacity 0.
    template <std::invocable MakeSlot>
    RingBuffer(std::size_t capacity, MakeSlot make_slot) {
        if (capacity == 0) {
            throw std::invalid_argument("a ring buffer needs at least one slot");
        }
        slots_.reserve(capacity);
        for (std::size_t i = 0; i < capacity; ++i) {
            slots_.push_back(make_slot());
        }
    }

    /// A ring whose slots are copies of a prototype. A copied std::vector keeps its size but not its capacity: give
    /// the prototype its full size.
    RingBuffer(std::size_t capacity, const Slot& prototype)
        : RingBuffer(capacity, [&prototype] { return prototype; }) {}

    RingBuffer(const RingBuffer&) = delete;
    RingBuffer& operator=(const RingBuffer&) = delete;

    /// Writer: the slot to fill next, with its old contents; nullptr when the ring is full. Asking
    /// again before publish() gives the same slot.
    Slot* try_claim() noexcept {
        const std::uint64_t published = published_.count.load(std::memory_order_relaxed);
        if (published - writer_.seen == slots_.size()) {
            writer_.seen = popped_.count.load(std::memory_order_acquire);
            if (published - writer_.seen == slots_.size()) {
                return nullptr;
            }
        }
        writer_.has_slot = true;
        return &slots_[writer_.position];
    }

    /// Writer: hands the claimed slot to the reader. Only after a try_claim() that gave a slot.
    void publish() noexcept {
        assert(writer_.has_slot && "publish() without a claimed slot");
        go_on(writer_, published_);
    }

    /// Reader: the oldest published slot; nullptr when the ring is empty. Stays the same until pop().
    Slot* try_front() noexcept {
        const std::uint64_t popped = popped_.count.load(std::memory_order_relaxed);
        if (popped == reader_.seen) {
            reader_.seen = published_.count.load(std::memory_order_acquire);
            if (popped == reader_.seen) {
                return nullptr;
            }
        }
        reader_.has_slot = true;
        return &slots_[reader_.position];
    }

    /// Reader: gives the front slot back to the writer. Only after a try_front() that gave a slot.
    void pop() noexcept {
        assert(reader_.has_slot && "pop() without a front slot");
        go_on(reader_, popped_);
    }

    /// Published slots that are not popped yet. From any thread; while the others run it is a snapshot, exact
    /// only in so far as it lies between 0 and capacity().
    std::size_t size() const noexcept {
        // popped first: it can only grow until published is read, so the difference is never negative.
        const std::uint64_t popped = popped_.count.load(std::memory_order_acquire);
        const std::uint64_t published = published_.count.load(std::memory_order_acquire);
        return static_cast<std::size_t>(std::min<std::uint64_t>(published - popped, slots_.size()));
    }

    std::size_t capacity() const noexcept { return slots_.size(); }

private:
    // Two cache lines: x86 cores fetch lines in pairs, so 64 bytes apart would still be shared.
    static constexpr std::size_t separation = 128;

    /// Slots published or popped: written by one side, read by both.
    struct alignas(separation) Counter {
        std::atomic<std::uint64_t> count{0};
    };
    /// The state of one side, which the other does not touch.
    struct alignas(separation) Side {
        std::uint64_t seen = 0;    // its copy of the other side's counter
        std::size_t position = 0;  // its own counter % capacity, without the division
        bool has_slot = false;
    };

    void go_on(Side& side, Counter& own) noexcept {
        side.has_slot = false;
        side.position = side.position + 1 == slots_.size() ? 0 : side.position + 1;
        own.count.store(own.count.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }

    std::vector<Slot> slots_;
    Counter published_;
    Counter popped_;
    Side writer_;
    Side reader_;
};

}  // namespace hertzline::stream
