#pragma once
// Memory of a stream: the ring between its threads, and the queues of slow subscribers.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/pacer.hpp"

namespace hertzline::stream {

/// The numbers of blocks in the ring. Blocks with samples of every sphere may be thousands of times as large as
/// others, and usually have no subscriber. So there is room for fewer of them.
struct RingSize {
    std::size_t blocks = 0;        ///< blocks of any kind
    std::size_t chain_blocks = 0;  ///< blocks with taps that have one channel per sphere
    /// The number of free blocks at which a full ring is filled again, at most a quarter. Waking up for each
    /// one costs more than filling it. But a core that fills many at a stretch keeps the threads waiting that send.
    std::size_t refill = std::numeric_limits<std::size_t>::max();
};

RingSize ring_size(const StreamFormat& format, Pace pace) noexcept;

/// Samples between two releases of blocks, for a ring of so many. It is half a millisecond of wall time: waking up for
/// each of ten thousand frames a second costs more than sending. But four releases at least fit into the ring, or it
/// would be full between two of them.
std::uint64_t samples_per_release(const StreamFormat& format, Pace pace, std::size_t blocks) noexcept;

/// Bytes of the ring.
double ring_bytes(const StreamFormat& format, Pace pace = Pace::realtime()) noexcept;

/// Bytes of the largest frame.
double largest_frame_bytes(const StreamFormat& format) noexcept;

/// The default memory for queues of slow subscribers: an eighth of the available memory, at most 1 GiB, also where it is not known.
double usual_queue_bytes(std::optional<std::uint64_t> available) noexcept;

}  // namespace hertzline::stream
