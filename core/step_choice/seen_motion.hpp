#pragma once
// The range of motion that a pilot has seen, and whether a motion has left it: an estimate of the error holds within that range only.

#include <algorithm>
#include <cstdint>

#include "core/model/drive.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline {

/// A motion has left the range when it exceeds it by more than this factor.
inline constexpr double drift_margin = 1.25;

/// The largest residual of the energy ledger that agrees with an error. Velocities that err by a share of their size change the energy
/// by twice that, and the ledger of a step that freezes its contacts may err some times more.
constexpr double residual_in_keeping_with(double error) noexcept {
    return 10 * error;
}

/// Contact events, counted by stretches of a burst's period, or of a burst where there is but one.
class EventRate {
public:
    explicit EventRate(const Drive& drive)
        : stretch_s_(drive.repetition_hz > 0 ? 1 / drive.repetition_hz : burst_duration_s(drive)) {}

    /// @param events so far, at a time that only grows [s]
    void note(double time_s, std::int64_t events) noexcept {
        last_s_ = time_s - begin_s_;
        last_ = static_cast<double>(events - events_at_begin_) / std::max(last_s_, 1e-300);
        if (last_s_ >= stretch_s_) {
            largest_ = std::max(largest_, last_);
            begin_s_ = time_s;
            events_at_begin_ = events;
            whole_ = true;
        }
    }

    /// The largest of any stretch; before the first one is complete, that of the part so far [1/s].
    double largest() const noexcept { return whole_ ? largest_ : last_; }
    /// Whether note() has just completed a stretch, with more events than another one's largest rate allows. As stretches need not
    /// begin with a burst they may have the events of one burst more.
    bool exceeds(double rate) const noexcept {
        return last_s_ >= stretch_s_ && last_ > drift_margin * rate * (1 + stretch_s_ / last_s_);
    }

private:
    double stretch_s_;
    double begin_s_ = 0;
    std::int64_t events_at_begin_ = 0;
    double last_s_ = 0;
    double last_ = 0;
    double largest_ = 0;
    bool whole_ = false;
};

/// Whether a motion is beyond the range by more than the margin. @param rate that has noted `now`
inline bool exceeds(const MotionExtremes& now, const EventRate& rate, const SeenMotion& seen) noexcept {
    return now.largest_press_m > drift_margin * seen.largest_press_m ||
           now.last_press_m > drift_margin * seen.last_press_m || rate.exceeds(seen.events_per_s) ||
           now.energy_residual > drift_margin * seen.energy_residual;
}

/// The range that a pilot has seen. @param error estimated, of its step
inline SeenMotion seen_motion(const MotionExtremes& motion, const EventRate& rate, double error) noexcept {
    return {motion.largest_press_m, motion.last_press_m, rate.largest(), residual_in_keeping_with(error)};
}

}  // namespace hertzline
