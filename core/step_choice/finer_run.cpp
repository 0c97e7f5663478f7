#include "core/step_choice/finer_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/integrators/stability.hpp"
#include "core/model/end.hpp"
#include "core/scene/elements.hpp"
#include "core/step_choice/pilot.hpp"
#include "core/step_choice/seen_motion.hpp"
#include "core/step_choice/step_advice.hpp"

namespace hertzline {

namespace {

constexpr double margin = 300;         // of the accuracy over the expected error of a piece: errors add up
constexpr double finer_pieces = 0.75;  // errors fall to a tenth or a fiftieth
constexpr double finer_water = 0.6;    // of the intervals that follow from the steps
constexpr double finer_grid = 0.5;     // errors fall to a half at least, at a contact's switching
constexpr double affordable_samples = 2e7;
constexpr double convincing = 0.7;   // of the accuracy: a difference may be less than the error
constexpr double lowest_slope = 10;  // of log(error) over log(step), from below

Scene with_finer_steps(const ResolvedScene& scene, std::size_t fit) {
    const double finer = is_series(scene.integrator()) ? finer_pieces : finer_grid;
    return with_another_fit(
        without_sleep(with_step(scene.scene(), scene.integrator(), finer * scene.step_s())), default_accuracy,
        fit);
}

/// Whether motions amplify errors so far that two fits of the discs which are alike by chance would hide them.
bool takes_two_fits(const Scene& scene) {
    return is_array(scene) && (Chain(element_scene(scene, 0)).damping == 0).all();
}

/// The largest error of a run, relative to its difference from one with finer steps.
double error_per_difference(const Scene& scene) noexcept {
    return is_series(*scene.numerics.integrator) ? 1 : 1 / (1 - finer_grid);
}

}  // namespace

std::optional<Resolution> resolve_unmeasured(const Scene& asked) {
    Resolution result;
    result.asked = asked.numerics;
    const IntegratorChoice choice = integrator_choice(asked);
    result.integrator_reason = choice.reason;
    result.advice.accuracy = asked_accuracy(asked.numerics);
    if (asked.numerics.step_s || !is_series(choice.integrator) || asked.chain.spheres > pilot_spheres ||
        !model_faults(asked).empty() || takes_two_fits(asked)) {
        return std::nullopt;
    }
    result.scene = with_poles(with_integrator(asked));
    if (pole_error(result.scene) > 0.5 * convincing * result.advice.accuracy) {
        return std::nullopt;
    }
    Numerics& numerics = result.scene.numerics;
    numerics.step_s = expected_piece(result.scene, result.advice.accuracy / margin);
    numerics.accuracy.reset();
    return result;
}

std::optional<Resolution> with_shorter_step(Resolution missed, double error) noexcept {
    if (!(error <= chaotic_error)) {
        return std::nullopt;
    }
    const double wanted = 0.1 * missed.advice.accuracy / error;
    *missed.scene.numerics.step_s *= std::clamp(std::pow(wanted, 1 / lowest_slope), 0.4, 0.8);
    return missed;
}

std::optional<Resolution> with_stable_step(Resolution tried, const Chain& chain,
                                           const Eigen::ArrayXd& peak_overlap) {
    constexpr double safety = 0.95;  // pilots may press the contacts a little further
    const double limit = safety * largest_stable_step(chain, peak_overlap, *tried.scene.numerics.integrator);
    if (*tried.scene.numerics.step_s <= limit || !(limit > 0)) {
        return std::nullopt;
    }
    tried.scene.numerics.step_s = limit;
    return tried;
}

FinerRun::FinerRun(const ResolvedScene& scene, std::size_t capacity, const std::atomic<bool>* stop,
                   std::int64_t max_steps, std::size_t threads, std::size_t fit)
    : run_(with_finer_steps(scene, fit), capacity, stop, max_steps, threads, finer_water), errors_(run_) {}

bool FinerRun::follow(const Samples& run) noexcept {
    if (!run_.advance(run.count)) {
        return false;
    }
    errors_.add(run, run_.block);
    compared_ += run_.block.count;
    return true;
}

ErrorEstimate FinerRun::estimate() const noexcept {
    const Scene& scene = run_.simulation.scene();
    const double difference = std::max(error_per_difference(scene) * errors_.worst(), least_error);
    const double of_fit = run_.fit_error();
    return {.error = is_array(scene) ? std::max(difference, of_fit)  // its runs have different fits
                                     : difference + of_fit,
            .over_s = static_cast<double>(compared_ - std::min<std::size_t>(compared_, 1)) /
                      scene.output.sample_rate_hz,
            .amplifies = false};
}

RunEstimate estimate_of_run(const ResolvedScene& scene, double run_s, const std::atomic<bool>* stop,
                            std::size_t threads) {
    const double wanted = std::ceil(run_s * scene.scene().output.sample_rate_hz) + 1;
    const auto samples = static_cast<std::int64_t>(std::min(wanted, affordable_samples));
    const double bodies = static_cast<double>(scene.scene().chain.spheres) + 1;
    const auto max_steps = static_cast<std::int64_t>(affordable_body_steps / bodies);
    JudgedRun run(scene, counted_block, stop, max_steps, threads);
    FinerRun follower(scene, counted_block, stop, max_steps, threads);
    std::optional<FinerRun> another;
    if (takes_two_fits(scene.scene())) {
        another.emplace(scene, counted_block, stop, max_steps, threads, 1);
    }
    EventRate event_rate(scene.scene().drive);
    for (std::int64_t left = samples; left > 0; left = samples - run.simulation.next_sample()) {
        const auto count = static_cast<std::size_t>(std::min<std::int64_t>(counted_block, left));
        if (!run.advance(count) || !follower.follow(run.block) || (another && !another->follow(run.block))) {
            break;
        }
        event_rate.note(
            static_cast<double>(run.simulation.next_sample()) / scene.scene().output.sample_rate_hz,
            run.simulation.contact_events());
    }
    ErrorEstimate found = follower.estimate();
    if (another) {
        found.error = std::max(found.error, another->estimate().error);
    }
    return {found, seen_motion(run.simulation.extremes(), event_rate, found.error)};
}

bool FinerRun::meets(double accuracy) const noexcept {
    return estimate().error <= convincing * accuracy;
}

}  // namespace hertzline
