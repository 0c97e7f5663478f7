#include "core/step_choice/long_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace hertzline {

namespace {

constexpr double affordable_body_pieces = 3e7;  // of the reference: thirty times those of ReferencePilot

JudgedRun reference_with(const Scene& scene, double step_s, double accuracy, const std::atomic<bool>* stop) {
    const Scene better =
        with_another_fit(without_sleep(with_step(scene, Integrator::taylor12, step_s)), accuracy);
    return {with_few_points(better), pilot_block, stop};
}

}  // namespace

LongEstimate::LongEstimate(const ResolvedScene& resolved, double accuracy, const std::atomic<bool>* stop)
    : sample_rate_hz_(resolved.scene().output.sample_rate_hz),
      reference_step_s_(
          step_of_reference(resolved.scene(), Chain(resolved.scene()), piece_error_for(accuracy))),
      longest_s_(reference_step_s_ * affordable_body_pieces /
                 (static_cast<double>(resolved.scene().chain.spheres) + 1)),
      used_(with_few_points(resolved.scene()), pilot_block, stop),
      reference_(reference_with(resolved.scene(), reference_step_s_, accuracy, stop)),
      finer_(reference_with(resolved.scene(), finer * reference_step_s_, accuracy, stop)),
      event_rate_(resolved.scene().drive),
      errors_(reference_),
      own_errors_(reference_) {}

bool LongEstimate::reach(double time_s) noexcept {
    const auto end = static_cast<std::int64_t>(std::ceil(std::min(time_s, longest_s_) * sample_rate_hz_));
    const Simulation& used = used_.simulation;
    while (used.next_sample() < end) {
        const auto count =
            static_cast<std::size_t>(std::min<std::int64_t>(pilot_block, end - used.next_sample()));
        if (!used_.advance(count) || !reference_.advance(count) || !finer_.advance(count)) {
            return false;
        }
        errors_.add(used_.block, reference_.block);
        own_errors_.add(finer_.block, reference_.block);
        event_rate_.note(static_cast<double>(used.next_sample()) / sample_rate_hz_, used.contact_events());
    }
    return true;
}

ErrorEstimate LongEstimate::estimate() const noexcept {
    const double own = own_errors_.worst();
    return {
        .error = std::max({errors_.worst(), with_safety_factor(own), least_error}) + reference_.fit_error(),
        .over_s = static_cast<double>(used_.simulation.next_sample()) / sample_rate_hz_,
        .amplifies = own > amplified_rounding};
}

SeenMotion LongEstimate::seen() noexcept {
    return seen_motion(used_.simulation.extremes(), event_rate_, estimate().error);
}

}  // namespace hertzline
