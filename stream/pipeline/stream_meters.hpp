#pragma once
// How a stream is doing.

#include <array>
#include <cstdint>

#include "core/taps.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/sources/sample_source.hpp"

namespace hertzline::stream {

/// A frame is late when it goes out this long after it was due. Shorter than that is the scheduler's business.
inline constexpr Nanoseconds late_after = std::chrono::milliseconds(5);

/// Frames of a topic.
struct TopicCount {
    std::int64_t sent = 0;     ///< handed to ZeroMQ while somebody subscribed
    std::int64_t dropped = 0;  ///< discarded by the program while somebody subscribed
};

/// How the stream is doing; the meters topic and the summary are made of this.
struct StreamMeters {
    std::int64_t samples = 0;  ///< index of the first sample that has not been due yet
    std::int64_t frames = 0;
    std::int64_t late_frames = 0;     ///< sent more than late_after after they were due
    double largest_lateness_s = 0;    ///< of any frame
    std::int64_t dropped_frames = 0;  ///< discarded because the ring was full and their time had passed
    double simulated_s = 0;
    double wall_s = 0;
    double load = 0;             ///< part of the wall time that the simulating thread worked
    double ring_fill = 0;        ///< 0 empty (no reserve) to 1 full (all reserve)
    double ring_high_water = 0;  ///< the largest so far
    double energy_residual = 0;
    SourceAccount account;
    std::array<TopicCount, 2 * tap_count> topics{};  ///< raw and np of each tap

    double real_time_factor() const noexcept { return wall_s > 0 ? simulated_s / wall_s : 0; }

    TopicCount& raw(Tap tap) noexcept { return topics[2 * static_cast<std::size_t>(tap)]; }
    TopicCount& np(Tap tap) noexcept { return topics[2 * static_cast<std::size_t>(tap) + 1]; }
    const TopicCount& raw(Tap tap) const noexcept { return topics[2 * static_cast<std::size_t>(tap)]; }
    const TopicCount& np(Tap tap) const noexcept { return topics[2 * static_cast<std::size_t>(tap) + 1]; }
};

}  // namespace hertzline::stream
