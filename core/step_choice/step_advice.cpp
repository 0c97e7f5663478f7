#include "core/step_choice/step_advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/integrators/stability.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/step_choice/pilot.hpp"

namespace hertzline {

namespace {

// --- steps on a grid: halved until two successive ones agree
// --------------------------------------------------

constexpr double max_body_steps = 1e6;           // of the coarsest pilot,
constexpr double max_body_steps_together = 3e7;  // and of all of them: about a second at worst
constexpr double first_phase = 0.6;              // omega h of the coarsest pilot: surely stable
constexpr double drive_periods = 1.0 / 20;       // and it resolves the drive
constexpr int max_halvings = 8;
constexpr double grid_safety = 0.5;  // of the wanted accuracy: where contacts switch, errors scatter about
                                     // their power law

/// The largest step not above `step` that divides the sample period or, beyond it, is a multiple of a quarter of it.
double fitted_to_samples(double step, double sample_rate_hz) {
    const double per_sample = 1 / (sample_rate_hz * step);
    constexpr double slack = 1e-9;
    if (per_sample >= 1 - slack) {
        return 1 / (sample_rate_hz * std::ceil(per_sample * (1 - slack)));
    }
    return std::floor(4 / per_sample * (1 + slack)) / (4 * sample_rate_hz);
}

/// Sampled once a step of the coarsest pilot.
PilotPlan plan_on_grid(const Scene& asked, double first_step) {
    PilotPlan plan{shortened(asked), 0};
    const double affordable = max_body_steps / static_cast<double>(plan.scene.chain.spheres + 1);
    plan.samples = static_cast<std::size_t>(
        std::clamp(std::ceil(watched_s(asked.drive) / first_step), 16.0, affordable));
    plan.scene.output.sample_rate_hz = 1 / first_step;
    return plan;
}

double coarsest_step(const Scene& scene) {
    const Chain chain(scene);
    const Eigen::ArrayXd overlaps = expected_overlaps(chain, scene.drive);
    const double omega = fastest_frequency(chain, overlaps);
    const double by_drive = drive_periods / scene.drive.frequency_hz;
    const double stable = largest_stable_step(chain, overlaps, *scene.numerics.integrator);
    return std::min({first_phase / omega, by_drive, stable / 2});
}

}  // namespace

StepAdvice advise_on_grid(const Scene& scene) {
    const Integrator integrator = *scene.numerics.integrator;
    const double target = grid_safety * scene.numerics.accuracy.value_or(default_accuracy);
    const double first = coarsest_step(scene);
    const PilotPlan plan = plan_on_grid(scene, first);
    const auto bodies = static_cast<std::size_t>(plan.scene.chain.spheres) + 1;

    StepAdvice advice;
    advice.accuracy = scene.numerics.accuracy.value_or(default_accuracy);
    advice.pilot_duration_s = static_cast<double>(plan.samples) * first;
    advice.pilots = 1;
    double step = first;
    double coarser_error = 0;
    double error = 0;
    double taken = 0;
    Pilot coarse = run_pilot(plan, integrator, step);
    for (int halvings = 0;; ++halvings) {
        Pilot fine = run_pilot(plan, integrator, step / 2);
        ++advice.pilots;
        coarser_error = error;
        // what remains at half the step is at most a third of the difference, by the lowest order in use (two)
        error = largest_difference(coarse, fine) * 4 / 3;
        coarse = std::move(fine);
        taken += 2 * static_cast<double>(plan.samples * bodies) * std::exp2(halvings + 1);
        if (error <= target || halvings == max_halvings || taken > max_body_steps_together) {
            break;
        }
        step /= 2;
    }
    advice.largest_stable_step_s = largest_stable_step(Chain(plan.scene), coarse.peak_overlap, integrator);
    advice.accuracy_met = error <= target;
    if (advice.accuracy_met && coarser_error > 0 && std::isfinite(coarser_error) && error > 0) {
        // between the step that is good enough and its double, which is not: a power law through both errors
        const double order = std::log2(coarser_error / error);
        const double growth = std::clamp(std::pow(target / error, 1 / order), 1.0, 2.0);
        step *= growth;
        error *= std::pow(growth, order);
    } else if (!advice.accuracy_met && error > chaotic_error) {
        step = first / 4;
    }
    advice.recommended_step_s = fitted_to_samples(step, scene.output.sample_rate_hz);
    advice.estimated_error = error;
    return advice;
}

// --- series: compared with one that is as good as exact
// -------------------------------------------------------

namespace {

constexpr double aim = 0.3;     // of the wanted accuracy
constexpr double most = 0.6;    // of it that a pilot may show,
constexpr double least = 0.12;  // and below which a longer step is tried
constexpr int max_trials = 10;
constexpr double slope = 13;  // of log(error) over log(step), roughly

double rounded_down(double step) {
    const double unit = std::pow(10, std::floor(std::log10(step)) - 2);
    return std::floor(step / unit * (1 + 1e-12)) * unit;
}

}  // namespace

StepAdvice advise_series(const Scene& scene, const ReferencePilot& reference) {
    const Integrator integrator = *scene.numerics.integrator;
    const Chain chain(shortened(scene));
    const Eigen::ArrayXd expected = expected_overlaps(chain, scene.drive);
    const double omega = fastest_frequency(chain, expected);

    StepAdvice advice;
    advice.accuracy = scene.numerics.accuracy.value_or(default_accuracy);
    advice.pilot_duration_s = reference.duration_s();
    advice.largest_stable_step_s = largest_stable_step(chain, reference.peak_overlap(), integrator);
    const double at_first = largest_stable_step(chain, expected, integrator);
    const double limit =
        std::min({0.98 * advice.largest_stable_step_s, 0.98 * at_first, longest_for_drive(scene.drive)});
    const double finest = std::min(reference.step_s(), limit);
    const auto trial_of = [&](double step) {
        ++advice.pilots;
        return reference.trial(integrator, step);
    };
    // the longest step whose error lies in the window, by secants on the logarithms
    double step = std::min(limit, SeriesSolver::phase_for(advice.accuracy / 30) / omega);
    double too_long = std::numeric_limits<double>::infinity();
    Trial best{0, std::numeric_limits<double>::infinity()};
    for (int trials = 0; trials < max_trials && step >= finest; ++trials) {
        step = rounded_down(step);
        const Trial trial = trial_of(step);
        if (trial.error > most * advice.accuracy) {
            too_long = std::min(too_long, step);
        } else if (step > best.step_s) {
            best = trial;
            if (trial.error >= least * advice.accuracy || step >= 0.97 * limit) {
                break;
            }
        }
        const double ratio = std::clamp(aim * advice.accuracy / std::max(trial.error, 1e-300), 1e-6, 1e6);
        step = std::min(step * std::pow(ratio, 1 / slope), limit);
        if (step <= best.step_s || step >= too_long) {
            step = std::sqrt(std::max(best.step_s, too_long / 2) * too_long);
        }
    }
    if (best.step_s == 0) {
        // nothing can be shown to be better than the reference: it is taken for as good as can be had, unless
        // no step makes a difference
        best = trial_of(rounded_down(finest));
        if (best.error > chaotic_error) {
            best = trial_of(rounded_down(std::min(limit, SeriesSolver::phase_for(1e-6) / omega)));
        }
    }
    advice.recommended_step_s = best.step_s;
    advice.estimated_error = best.error;
    advice.accuracy_met = best.error <= advice.accuracy;
    return advice;
}

}  // namespace hertzline
