#pragma once
// A trigger at a level, as a scope has it: the first crossing, then none for the hold-off.

#include <cstdint>
#include <deque>
#include <optional>

#include "scope/pictures/stream_history.hpp"

namespace hertzline::scope {

enum class Slope { rising, falling };

/// What a crossing is.
struct LevelRequest {
    double level = 0;  ///< unit of the stream
    Slope slope = Slope::rising;
    std::uint64_t hold_off = 0;  ///< samples after a crossing in which there is no other
    bool operator==(const LevelRequest&) const = default;
};

/// Looks at each sample once, as it comes.
class LevelTrigger {
public:
    /// Begins anew when the request differs from the one before.
    void ask(const LevelRequest& request);
    /// Looks at what has come since the last call.
    void look_at(const SampleRing& samples);
    /// The latest crossing at `sample` or before: the first sample at the level or beyond it.
    std::optional<std::uint64_t> latest_by(std::uint64_t sample) const;

private:
    LevelRequest request_;
    std::optional<std::uint64_t> seen_;  // up to here
    bool before_ = false;                // the last sample that was seen lies before the level
    std::deque<std::uint64_t> crossings_;
};

}  // namespace hertzline::scope
