#pragma once
// How much a stream holds in memory: the ring between its threads, and the queues of slow subscribers.

#include <cstddef>
#include <cstdint>
#include <limits>

#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/pacer.hpp"

namespace hertzline::stream {

/// How many blocks the ring holds. Blocks with samples of every sphere may be thousands of times as large as the
/// others, and usually nobody wants them. So there is room for fewer of them.
struct RingSize {
    std::size_t blocks = 0;        ///< of any kind
    std::size_t chain_blocks = 0;  ///< of them, with taps that have one channel per sphere
    /// So many have to be free before the full ring is filled again, but never more than a quarter. Waking up for each
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

/// Memory for the queues of slow subscribers when the user does not say: an eighth of what is available, at most 1 GiB.
double usual_queue_bytes();

}  // namespace hertzline::stream
