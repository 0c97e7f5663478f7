#pragma once
// The simulating thread: takes blocks from a source and puts them into the ring, ahead of their time, until the
// ring is full. It allocates nothing, takes no lock, writes no message, and makes no system call but to sleep and to
// wake the sending thread.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/ring_buffer.hpp"
#include "stream/pipeline/sleeper.hpp"
#include "stream/threads.hpp"

namespace hertzline::stream {

/// The thread's name in the system's tools (top -H).
inline constexpr const char* simulating_thread_name = "simulating";

/// The treatment of a block whose time has passed while the ring is full.
enum class OnOverrun {
    drop,  ///< it is discarded and counted, the stream stays in step with the clock
    wait,  ///< the stream falls behind
};

/// The taps to be computed for subscribers. Each new demand has a new generation. It distinguishes a block made after
/// a subscriber came from an older one in the ring, made before another left. It is aligned to its size, so that every compiler reads
/// and writes it without a lock.
struct alignas(std::uint64_t) Demand {
    TapSet taps;
    std::uint32_t generation = 0;
};
static_assert(std::atomic<Demand>::is_always_lock_free);

/// A slot of the ring.
struct Block {
    Samples small;              ///< room for the taps with one channel
    Samples* chain = nullptr;   ///< room for per-sphere taps, in blocks that hold them; else nullptr
    Demand demand;              ///< the demand when the block was made
    TapSet missing;             ///< of it, that the source could not give yet
    std::uint64_t seq = 0;      ///< counts blocks, discarded ones included
    std::uint64_t dropped = 0;  ///< blocks of the run discarded before this one
    SourceAccount account;
    MotionExtremes motion;  ///< when it was last asked for, but in this epoch
    Epoch epoch;            ///< the epoch of all its samples

    Samples& samples() noexcept { return chain != nullptr ? *chain : small; }
    const Samples& samples() const noexcept { return chain != nullptr ? *chain : small; }
};

/// The simulating thread and the ring that it fills.
class Producer {
public:
    /// @param pacer has the times at which samples are due; started before go() @param samples unset: to the source's
    /// end
    Producer(SampleSource& source, const Pacer& pacer, RingSize size, std::optional<std::int64_t> samples,
             OnOverrun on_overrun);
    ~Producer();
    Producer(const Producer&) = delete;
    Producer& operator=(const Producer&) = delete;

    /// Makes the thread, which waits for go(). @returns a sentence for each option that the system refused.
    std::vector<std::string> start(const ThreadOptions& options);
    void go() noexcept;
    /// Ends the thread; afterwards the source is the caller's.
    void stop() noexcept;

    const RingBuffer<Block>& ring() const noexcept { return ring_; }
    /// Returns the oldest block, or nullptr. It stays until pop(). For one thread, as the next two.
    const Block* front() noexcept { return ring_.try_front(); }
    /// The number of blocks of its kind in the ring.
    std::size_t room_for(const Block& block) const noexcept {
        return block.chain != nullptr ? chain_blocks_.size() : ring_.capacity();
    }
    /// Gives the oldest block back.
    void pop() noexcept;
    /// Waits for a block, until the deadline or the end. Flat out it waits for several, unless a live drive wants to be heard at once:
    /// waking up for each one costs more than sending it.
    void wait_for_block(Nanoseconds deadline) noexcept;

    /// Whether no further block will come.
    bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }

    /// Sets the demand. For one thread. @returns its generation, a new one if it changed.
    std::uint32_t want(TapSet taps) noexcept;
    /// Requests the extremes of the motion with the next block.
    void want_motion() noexcept { motion_wanted_.store(true, std::memory_order_relaxed); }

    std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
    /// Index of the sample after the last one that was discarded; the source's first sample when none was.
    std::int64_t discarded_to() const noexcept { return discarded_to_.load(std::memory_order_relaxed); }
    /// Time spent on work so far [ns].
    Nanoseconds busy() const noexcept { return Nanoseconds{busy_ns_.load(std::memory_order_relaxed)}; }

    /// The source's first sample.
    std::int64_t origin() const noexcept { return origin_; }

private:
    void produce() noexcept;
    bool wait_for_go() noexcept;
    Block* try_claim() noexcept;
    Block* wait_for_slot(std::int64_t first, std::int64_t count) noexcept;
    bool fill(Block& block, std::int64_t count) noexcept;
    bool stopping() const noexcept { return stopping_.load(std::memory_order_relaxed); }
    bool makes_chain(TapSet taps) const noexcept { return !(taps & chain_taps_).empty(); }
    std::size_t free_chain_blocks() const noexcept;
    bool has_room() const noexcept;
    bool has_enough() const noexcept { return ring_.size() >= enough_; }
    static std::size_t quarter_of(std::size_t blocks) noexcept { return blocks < 4 ? 1 : blocks / 4; }
    /// The number of free slots at which a full ring is filled again.
    std::size_t refill_of(std::size_t blocks) const noexcept { return std::min(refill_, quarter_of(blocks)); }

    SampleSource& source_;
    const Pacer& pacer_;
    std::int64_t frame_samples_;
    std::int64_t origin_;
    std::int64_t end_;
    OnOverrun on_overrun_;
    std::size_t refill_;
    MotionExtremes last_motion_;
    std::int64_t epoch_seen_ = 0;  // the simulating thread's, as last_motion_
    RingBuffer<Block> ring_;
    std::size_t enough_;  // blocks, for which the thread that takes them is woken
    // Used in turn, by the blocks that hold taps of every sphere.
    TapSet chain_taps_;
    std::vector<Samples> chain_blocks_;
    std::atomic<std::uint64_t> chain_blocks_filled_{0};    // written by the simulating thread
    std::atomic<std::uint64_t> chain_blocks_returned_{0};  // written by the thread that takes the blocks
    Sleeper filling_;                                      // the simulating thread waits here
    Sleeper emptying_;                                     // the thread that takes the blocks

    std::atomic<Demand> demand_{Demand()};
    static_assert(std::atomic<Demand>::is_always_lock_free);
    std::atomic<bool> motion_wanted_{false};
    std::atomic<bool> going_{false};
    std::atomic<bool> stopping_{false};
    std::atomic<bool> finished_{false};
    std::atomic<std::uint64_t> dropped_{0};
    std::atomic<std::int64_t> discarded_to_;
    std::atomic<std::int64_t> busy_ns_{0};
    std::thread thread_;
};

}  // namespace hertzline::stream
