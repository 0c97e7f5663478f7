#pragma once
// What a stream is to do and how it is doing, and the messages that tell its subscribers.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/taps.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/run_id.hpp"
#include "stream/sources/sample_source.hpp"

namespace hertzline::stream {

enum class StreamStart { at_once, with_first_subscriber };

/// What a stream is to do.
struct StreamOptions {
    std::string run = make_run_id();
    nlohmann::ordered_json about;  ///< of the samples: what meta says beside their format (stream/provenance)
    Pace pace = Pace::realtime();
    std::optional<std::int64_t> samples{};  ///< unset: to the end, or until stopped
    StreamStart start = StreamStart::at_once;
    OnOverrun on_overrun = OnOverrun::drop;
    ThreadOptions thread{};
};

/// A frame is late when it goes out this long after it was due. Shorter than that is the scheduler's
/// business.
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
    std::array<TopicCount, 2 * all_taps.size()> topics{};  ///< raw and np of each tap

    double real_time_factor() const noexcept { return wall_s > 0 ? simulated_s / wall_s : 0; }

    TopicCount& raw(Tap tap) noexcept { return topics[2 * static_cast<std::size_t>(tap)]; }
    TopicCount& np(Tap tap) noexcept { return topics[2 * static_cast<std::size_t>(tap) + 1]; }
    const TopicCount& raw(Tap tap) const noexcept { return topics[2 * static_cast<std::size_t>(tap)]; }
    const TopicCount& np(Tap tap) const noexcept { return topics[2 * static_cast<std::size_t>(tap) + 1]; }
};

/// The message of the meta topic: format, streams, units, and what the plan says about the samples.
std::string meta_json(const StreamOptions& plan, const StreamFormat& format, const std::string& run_id);

/// What meters and summary say alike: how the stream keeps time and what it has sent, as flat members.
void add_stream_members(nlohmann::ordered_json& object, const StreamMeters& meters, TapSet taps);

/// The message of the meters topic.
std::string meters_json(const StreamMeters& meters, TapSet taps, const std::string& run_id);

}  // namespace hertzline::stream
