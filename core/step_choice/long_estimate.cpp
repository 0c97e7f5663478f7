#include "core/step_choice/long_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace hertzline {

namespace {

constexpr double affordable_body_pieces = 3e7;  // of the reference: thirty times those of ReferencePilot

double bodies(const Scene& scene) noexcept {
    return static_cast<double>(scene.chain.spheres) + 1;
}

}  // namespace

LongEstimate::Run::Run(const Scene& of, Integrator integrator, double step_s, const std::atomic<bool>* stop)
    : scene(never_at_rest(with_step(of, integrator, step_s))),
      chain(scene),
      solver(make_solver(
          scene, chain,
          {.taps = judged_outputs & taps_of(scene.end), .ledger = LedgerKeeping::off, .stop = stop})),
      block(judged_outputs & taps_of(scene.end), 0, pilot_block) {}

LongEstimate::LongEstimate(const Scene& scene, double accuracy, const std::atomic<bool>* stop)
    : sample_rate_hz_(scene.output.sample_rate_hz),
      reference_step_s_(step_of_reference(scene, Chain(scene), accuracy)),
      longest_s_(reference_step_s_ * affordable_body_pieces / bodies(scene)),
      used_(scene, *scene.numerics.integrator, *scene.numerics.step_s, stop),
      reference_(scene, Integrator::taylor12, reference_step_s_, stop),
      finer_(scene, Integrator::taylor12, finer * reference_step_s_, stop),
      event_rate_(scene.drive) {}

bool LongEstimate::reach(double time_s) noexcept {
    const auto end = static_cast<std::int64_t>(std::ceil(std::min(time_s, longest_s_) * sample_rate_hz_));
    while (used_.solver->next_sample() < end) {
        const auto count =
            static_cast<std::size_t>(std::min<std::int64_t>(pilot_block, end - used_.solver->next_sample()));
        for (Run* const run : {&used_, &reference_, &finer_}) {
            if (run->solver->fill(run->block, count, run->block.taps()) != Status::running) {
                return false;
            }
        }
        errors_.add(used_.block, reference_.block);
        own_errors_.add(finer_.block, reference_.block);
        event_rate_.note(static_cast<double>(used_.solver->next_sample()) / sample_rate_hz_,
                         used_.solver->contact_events());
    }
    return true;
}

ErrorEstimate LongEstimate::estimate() const noexcept {
    const double own = own_errors_.worst();
    const double of_fit = used_.chain.end.plate ? used_.chain.end.plate->fit_error() : 0;
    return {.error = std::max(errors_.worst(), careful(own)) + of_fit,
            .over_s = static_cast<double>(used_.solver->next_sample()) / sample_rate_hz_,
            .amplifies = own > amplified_rounding};
}

SeenMotion LongEstimate::seen() noexcept {
    return seen_motion(extent_of(*used_.solver, used_.chain), event_rate_, estimate().error);
}

}  // namespace hertzline
