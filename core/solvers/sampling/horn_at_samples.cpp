#include "core/solvers/sampling/horn_at_samples.hpp"

namespace hertzline {

void HornAtSamples::work_out(std::int64_t first) noexcept {
    std::array<HornStep, ToneBurst::batch_steps> steps;
    burst_.fill(first, steps.data(), ToneBurst::batch_steps);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        // a step with a break is described by the piece at its middle, which may not be that of its start
        motion_[i] = steps[i].breaks ? burst_.at(first + static_cast<std::int64_t>(i), 0) : steps[i].start;
    }
    first_ = first;
}

}  // namespace hertzline
