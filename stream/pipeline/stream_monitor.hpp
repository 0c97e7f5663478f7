#pragma once
// What keeps the meters of a stream while it runs.

#include <cstdint>

#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/pipeline/ring_buffer.hpp"
#include "stream/pipeline/stream_meters.hpp"
#include "stream/pipeline/topic_demand.hpp"

namespace hertzline::stream {

/// Keeps the meters of a stream. For the sending thread.
class StreamMonitor {
public:
    /// @param origin index of the first sample
    StreamMonitor(std::int64_t origin, double sample_rate_hz) noexcept;

    const StreamMeters& meters() const noexcept { return meters_; }
    StreamMeters& meters() noexcept { return meters_; }

    /// A block went out so long after it was due.
    void count(const Block& block, Nanoseconds lateness) noexcept;

    /// Blocks that were discarded before they had frames, since the start: one frame of each topic that is wanted.
    void count_dropped(std::uint64_t dropped, const TopicDemand& demand) noexcept;

    /// All samples before this one have been due, though nobody may have sent them.
    void pass(std::int64_t sample) noexcept;

    void look_at(const RingBuffer<Block>& ring) noexcept;

    /// The load since the last time, and how long the stream has run.
    /// @param start when it began @param busy what the simulating thread has worked since
    void measure(Nanoseconds now, Nanoseconds start, Nanoseconds busy) noexcept;

    /// The same for the whole run.
    void measure_all(Nanoseconds now, Nanoseconds start, Nanoseconds busy) noexcept;

private:
    std::int64_t origin_;
    double sample_rate_hz_;
    StreamMeters meters_;
    std::uint64_t dropped_counted_ = 0;
    Nanoseconds measured_at_{0};
    Nanoseconds busy_then_{0};
};

}  // namespace hertzline::stream
