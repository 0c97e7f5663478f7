#pragma once
// How much a stream holds in memory: the ring between its threads, and the queues of slow subscribers.

#include <cstddef>

#include "stream/pipeline/pacer.hpp"
#include "stream/sources/sample_source.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// Blocks that the ring holds.
std::size_t ring_slots(const StreamFormat& format, Pace pace) noexcept;

/// Bytes of the ring.
double ring_bytes(const StreamFormat& format, Pace pace = Pace::realtime()) noexcept;

/// How long a queue the publisher shall keep for a slow subscriber: half a second of the small streams, and at
/// most half a GiB of the large ones.
PublisherOptions publisher_options(const StreamFormat& format) noexcept;

}  // namespace hertzline::stream
