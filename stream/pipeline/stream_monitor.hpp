#pragma once
// The meters of a stream, for its sending thread.

#include <array>
#include <cstdint>
#include <optional>

#include "hertzline/taps.hpp"
#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/pipeline/ring_buffer.hpp"
#include "stream/pipeline/topic_demand.hpp"

namespace hertzline::stream {

/// A frame is late when it goes out this long after it was due. Shorter delays are the scheduler's business.
inline constexpr Nanoseconds late_after = std::chrono::milliseconds(5);

/// Frames of a topic.
struct TopicCount {
    std::int64_t sent = 0;     ///< handed to ZeroMQ while the topic had subscribers
    std::int64_t dropped = 0;  ///< discarded by the program, or not made, while the topic had subscribers
};

/// The state of the stream, for the meters topic and the summary.
struct StreamMeters {
    std::int64_t samples = 0;  ///< index of the first sample that has not been due yet
    std::int64_t frames = 0;
    std::int64_t late_frames = 0;     ///< sent more than late_after after they were due
    double largest_lateness_s = 0;    ///< largest of all frames, and of one that has still to come
    std::int64_t dropped_frames = 0;  ///< discarded because the ring was full and their time had passed
    double simulated_s = 0;
    double wall_s = 0;
    double load = 0;             ///< part of the wall time that the simulating thread worked
    double ring_fill = 0;        ///< 0 empty (no reserve) to 1 full (all reserve)
    double ring_high_water = 0;  ///< the largest so far
    MotionExtremes motion;       ///< some tenths of a second ago
    SourceAccount account;
    std::optional<DriveCounts> drive;                ///< of a live drive
    std::array<TopicCount, 2 * tap_count> topics{};  ///< raw and np of each tap

    double real_time_factor() const noexcept { return wall_s > 0 ? simulated_s / wall_s : 0; }

    TopicCount& raw(Tap tap) noexcept { return topics[2 * static_cast<std::size_t>(tap)]; }
    TopicCount& np(Tap tap) noexcept { return topics[2 * static_cast<std::size_t>(tap) + 1]; }
    const TopicCount& raw(Tap tap) const noexcept { return topics[2 * static_cast<std::size_t>(tap)]; }
    const TopicCount& np(Tap tap) const noexcept { return topics[2 * static_cast<std::size_t>(tap) + 1]; }
};

/// Keeps the meters of a stream. For the sending thread.
class StreamMonitor {
public:
    /// @param origin index of the first sample
    StreamMonitor(std::int64_t origin, double sample_rate_hz) noexcept;

    const StreamMeters& meters() const noexcept { return meters_; }
    StreamMeters& meters() noexcept { return meters_; }

    /// Notes a block and its lateness.
    void count(const Block& block, Nanoseconds lateness) noexcept;

    /// Notes how late the next block is already.
    void wait(Nanoseconds lateness) noexcept;

    /// Blocks that were discarded before they had frames, since the start: one frame of each topic that is wanted.
    void count_dropped(std::uint64_t dropped, const TopicDemand& demand) noexcept;

    /// Notes that all samples before this one have been due, whether or not they were sent.
    void pass(std::int64_t sample) noexcept;

    void look_at(const RingBuffer<Block>& ring) noexcept;

    /// The load since the last time, and how long the stream has run.
    /// @param start when it began @param busy time that the simulating thread has computed since
    void measure(Nanoseconds now, Nanoseconds start, Nanoseconds busy) noexcept;

    /// The load over the whole run.
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
