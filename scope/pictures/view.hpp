#pragma once
// A page's view of some channels: finds the trigger of the first one, and makes the picture of the window around it. Many
// samples become few pixels, and none is lost.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scope/pictures/channel_history.hpp"
#include "scope/pictures/level_trigger.hpp"
#include "scope/pictures/picture.hpp"
#include "scope/pictures/view_request.hpp"

namespace hertzline::scope {

/// The smallest and the largest sample of each column; NaN where none is held.
struct Envelope {
    std::vector<float> low;
    std::vector<float> high;
};

/// Reduces samples to columns. Column i of C holds the samples from first + i count / C to before first + (i + 1) count / C, rounded down: each sample of
/// the window lies in exactly one. Missing samples are ignored.
/// @param first may lie before the first sample of the run @param columns at least 1
Envelope envelope(const SampleRing& samples, std::int64_t first, std::uint64_t count, std::size_t columns);

/// The view of one page. For one thread.
class View {
public:
    /// Sets the request.
    void ask(const ViewRequest& request);
    /// Other samples follow, of another channel or another run. Held pictures stay.
    void begin_anew();
    const ViewRequest& request() const noexcept { return request_; }

    /// Returns the bytes of the next picture; nothing when the page has the latest one.
    /// @param beside those of the request, in its order @param now_s since 1970 [s]
    std::optional<std::string> picture(const ChannelHistory& history,
                                       std::span<const ChannelHistory* const> beside, double now_s);

    /// Whether pictures stand still.
    bool is_held() const noexcept { return !held_.empty(); }

private:
    struct Trigger {
        std::uint64_t sample = 0;
        std::uint64_t burst = 0;
        bool free = false;
        bool operator==(const Trigger&) const = default;
    };
    struct Window {
        std::int64_t from = 0;  // samples after the trigger
        std::uint64_t count = 0;
    };

    Window window(double fs, std::size_t capacity) const noexcept;
    std::optional<Trigger> trigger(const ChannelHistory& history, std::uint64_t end, const Window& window,
                                   double now_s);
    std::optional<Trigger> found_trigger(const ChannelHistory& history, std::uint64_t latest);
    bool is_to_be_held(const Trigger& trigger) const noexcept;
    std::string bytes(std::span<const ChannelHistory* const> histories, const Window& window,
                      const Trigger& trigger) const;

    ViewRequest request_;
    LevelTrigger level_;
    std::map<Channel, ChannelHistory> held_;  // empty: pictures advance
    std::optional<Trigger> shown_;
    std::optional<Trigger> found_;  // the last one, and the time of its first sight
    double triggered_at_s_ = 0;
    bool changed_ = true;
    std::optional<std::uint64_t> single_from_;  // a single shot shows a trigger from this sample on
};

}  // namespace hertzline::scope
