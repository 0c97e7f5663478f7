#include "stream/pipeline/load_shedder.hpp"

#include <algorithm>

#include "stream/pipeline/stream_monitor.hpp"

namespace hertzline::stream {

void LoadShedder::judge(TapSet taken, Nanoseconds lateness, std::uint64_t dropped, Nanoseconds now) noexcept {
    if (now - judged_at_ < period) {
        return;
    }
    const bool is_behind = lateness > behind || dropped > dropped_;
    const bool catches_up = lateness < lateness_;
    const bool in_time = lateness <= late_after;
    shed_ &= taken;
    const TapSet left = taken - shed_;
    if (lateness >= hopeless && left.size() <= 1) {
        shed_ = {};
        gave_up_ = true;
    } else if (is_behind && was_behind_ && !catches_up && !gave_up_ && left.size() > 1) {
        shed_one(left, now);
    } else if (in_time && !shed_.empty() && now >= comes_back_at_) {
        shed_ = {};
        came_back_at_ = now;
    }
    gave_up_ = gave_up_ && !in_time;
    judged_at_ = now;
    lateness_ = lateness;
    dropped_ = dropped;
    was_behind_ = is_behind;
}

void LoadShedder::shed_one(TapSet of, Nanoseconds now) noexcept {
    if (shed_.empty()) {
        rest_ = now - came_back_at_ < rest_ ? std::min<Nanoseconds>(2 * rest_, longest_rest) : rest;
    }
    shed_ |= largest(of);
    comes_back_at_ = now + rest_;
}

/// Of those of the same size the last one.
Tap LoadShedder::largest(TapSet taps) const noexcept {
    Tap found = *taps.begin();
    for (const Tap tap : taps) {
        found = format_.channels(tap) >= format_.channels(found) ? tap : found;
    }
    return found;
}

}  // namespace hertzline::stream
