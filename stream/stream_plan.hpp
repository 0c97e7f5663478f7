#pragma once
// What a stream is to do and how it is doing, and the messages that tell its subscribers.

#include <cstdint>
#include <optional>
#include <string>

#include "core/scene.hpp"
#include "stream/curve.hpp"
#include "stream/pacer.hpp"

namespace hertzline {

enum class StreamStart { at_once, with_first_subscriber };

struct StreamPlan {
    Scene scene;  ///< resolved (core/numerics.hpp)
    std::string scene_hash;
    std::string version;
    std::optional<double> estimated_error{};  ///< of the velocities, relative L2; unset: unknown
    Pace pace = Pace::realtime();
    std::optional<std::int64_t> samples;  ///< unset: until stopped
    StreamStart start = StreamStart::at_once;
    Security security = Security::none;  ///< of the publisher
};

/// A frame is late when it goes out this long after it was due. Shorter than that is the scheduler's
/// business.
inline constexpr Nanoseconds late_after = std::chrono::milliseconds(5);

/// How the stream is doing; the meters topic and the summary are made of this.
struct StreamMeters {
    std::int64_t samples = 0;  ///< sent or passed over because nobody wanted them
    std::int64_t frames = 0;
    std::int64_t late_frames = 0;     ///< sent more than late_after after they were due
    std::int64_t dropped_frames = 0;  ///< discarded because the ring was full and their time had passed
    double simulated_s = 0;
    double wall_s = 0;
    double load = 0;       ///< part of the wall time that the simulating thread worked
    double ring_fill = 0;  ///< 0 empty (no reserve) to 1 full (all reserve)
    double energy_residual = 0;
    std::int64_t contact_events = 0;
    std::int64_t steps = 0;

    double real_time_factor() const noexcept { return wall_s > 0 ? simulated_s / wall_s : 0; }
};

/// The message of the meta topic: the resolved scene, hash, version, streams, rates, units.
std::string meta_json(const StreamPlan& plan, const std::string& run_id);

/// The message of the meters topic.
std::string meters_json(const StreamMeters& meters, const std::string& run_id);

}  // namespace hertzline
