#pragma once
// A level trigger: the first crossing, then none for the hold-off.

#include <cstdint>
#include <deque>
#include <optional>

#include "scope/pictures/channel_history.hpp"

namespace hertzline::scope {

enum class Slope { rising, falling };

/// A level and its crossings.
struct LevelRequest {
    double level = 0;  ///< unit of the stream
    Slope slope = Slope::rising;
    std::uint64_t hold_off = 0;  ///< samples after a crossing without another one
    bool operator==(const LevelRequest&) const = default;
};

/// Finds the crossings of samples, each of which it reads once.
class LevelTrigger {
public:
    /// Sets the request. A new one restarts the trigger.
    void ask(const LevelRequest& request);
    /// Looks at the samples since the last call.
    void look_at(const SampleRing& samples);
    /// Returns the latest crossing at `sample` or before: the first sample at the level or beyond it.
    std::optional<std::uint64_t> latest_by(std::uint64_t sample) const;

private:
    LevelRequest request_;
    std::optional<std::uint64_t> seen_;  // up to here
    bool before_ = false;                // the last sample lies before the level
    std::deque<std::uint64_t> crossings_;
};

}  // namespace hertzline::scope
