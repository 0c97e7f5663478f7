#include "core/model/horn.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/sampled_horn.hpp"
#include "core/model/tone_burst.hpp"

namespace hertzline {

HornMotion Polynomial::at(double time_s) const noexcept {
    const double u = (time_s - middle_s) / half_s;
    HornMotion motion;
    for (std::size_t k = count; k-- > 0;) {
        motion.a = motion.a * u + 2 * motion.v;
        motion.v = motion.v * u + motion.x;
        motion.x = motion.x * u + terms[k];
    }
    motion.v /= half_s;
    motion.a /= half_s * half_s;
    return motion;
}

double BurstClock::since(std::int64_t step, double fraction, std::int64_t burst) const noexcept {
    // step * h - burst / repetition_hz, both products in two parts: near-equal large numbers are subtracted
    const auto n = static_cast<double>(step);
    const double t = n * step_;
    const double t_low = std::fma(n, step_, -t);
    if (burst == 0) {
        return (t - start_) + (t_low + fraction * step_);
    }
    const auto k = static_cast<double>(burst);
    const double start = k / repetition_hz_;
    const double start_low = std::fma(-start, repetition_hz_, k) / repetition_hz_;
    return ((t - start) - start_) + ((t_low - start_low) + fraction * step_);
}

std::int64_t BurstClock::burst_at(std::int64_t step, double fraction) const noexcept {
    std::int64_t burst = 0;
    if (repetition_hz_ > 0) {
        const double bursts = (static_cast<double>(step) + fraction) * step_ * repetition_hz_;
        burst = std::max<std::int64_t>(0, static_cast<std::int64_t>(bursts));
        // rounding may have put the time on the wrong side of a burst's start
        if (burst > 0 && since(step, fraction, burst) < 0) {
            --burst;
        } else if (since(step, fraction, burst + 1) >= 0) {
            ++burst;
        }
    }
    return burst;
}

void Horn::at_starts(std::int64_t first, HornMotion* motion) noexcept {
    std::array<HornStep, batch_steps> steps;
    fill(first, steps.data(), batch_steps);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        // a step with a break is described by the piece at its middle, which may not be that of its start
        motion[i] = steps[i].breaks ? at(first + static_cast<std::int64_t>(i), 0) : steps[i].start;
    }
}

std::unique_ptr<Horn> make_horn(const Drive& drive, double step_s,
                                std::shared_ptr<const PiecewiseMotion> live) {
    if (drive.kind == DriveKind::live && live) {
        return std::make_unique<SampledHorn>(drive, step_s, std::move(live));
    }
    if (drive.kind == DriveKind::file || drive.kind == DriveKind::live) {
        return std::make_unique<SampledHorn>(drive, step_s, SampledMotion::of(drive));
    }
    return std::make_unique<ToneBurst>(drive, step_s);
}

}  // namespace hertzline
