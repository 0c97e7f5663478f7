#pragma once
// A horn that moves as samples say: a record, burst after burst, or those that come while it moves.

#include <memory>
#include <span>

#include "core/model/horn.hpp"
#include "core/model/sampled_motion.hpp"

namespace hertzline {

class SampledHorn final : public Horn {
public:
    SampledHorn(const Drive& drive, double step_s, std::shared_ptr<const PiecewiseMotion> motion);

    using Horn::at;
    HornMotion at(std::int64_t step, double fraction, double on_piece) const noexcept override;
    /// Its pieces continue each other.
    double next_break(std::int64_t /*step*/, double /*after*/) const noexcept override { return 1; }
    bool fill(std::int64_t first, HornStep* steps, int count) noexcept override;
    void at_starts(std::int64_t first, HornMotion* motion) noexcept override;
    SmoothDrive smooth(std::int64_t step, double fraction) const noexcept override;
    void series(const SmoothDrive& piece, double since_look_up, double unit_s,
                std::span<double> terms) const noexcept override;

private:
    BurstClock clock_;
    std::shared_ptr<const PiecewiseMotion> motion_;
};

}  // namespace hertzline
