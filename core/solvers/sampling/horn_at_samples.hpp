#pragma once
// The horn's motion at the samples, for taps that show the drive.

#include <array>
#include <cstdint>

#include "core/model/tone_burst.hpp"

namespace hertzline {

/// Works out a batch of samples at a time: a sample at a time would take ten times as long as all else that a sample needs.
class HornAtSamples {
public:
    HornAtSamples(const Drive& drive, double sample_rate_hz) : burst_(drive, 1 / sample_rate_hz) {}

    /// [m/s]; where the motion jumps, that of the piece which begins there. @param sample index since the start
    double velocity(std::int64_t sample) noexcept { return at(sample).v; }
    /// As velocity(), with displacement and acceleration.
    const HornMotion& at(std::int64_t sample) noexcept {
        if (sample < first_ || sample >= first_ + ToneBurst::batch_steps) {
            work_out(sample - sample % ToneBurst::batch_steps);
        }
        return motion_[static_cast<std::size_t>(sample - first_)];
    }

private:
    void work_out(std::int64_t first) noexcept;

    ToneBurst burst_;  ///< its steps are sample periods
    std::int64_t first_ = -ToneBurst::batch_steps;
    std::array<HornMotion, ToneBurst::batch_steps> motion_{};
};

}  // namespace hertzline
