#include "core/step_choice/step_advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/integrators/stability.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/step_choice/pilot.hpp"

namespace hertzline {

double asked_accuracy(const Numerics& numerics) noexcept {
    return numerics.accuracy.value_or(default_accuracy);
}

namespace {

constexpr double most = 0.6;  // of the wanted accuracy that a pilot may show

/// The error that a step is judged by: its own, or that at which in one scene of five hundred a sample of the output would fall on
/// the wrong side of a switching. Their number falls as the error does.
double judged_error(const Trial& trial, double accuracy) noexcept {
    constexpr double tolerable = 0.002;  // samples
    return std::max(trial.error, accuracy * most * trial.wrong_sides / tolerable);
}

// Steps on a grid

constexpr double max_body_steps_together = 5e7;  // of all pilots: about a second at worst
constexpr double first_phase = 0.6;              // omega h of the coarsest pilot: surely stable
constexpr double drive_periods = 1.0 / 20;       // and it resolves the drive
constexpr int max_halvings = 9;
constexpr double grid_safety = 0.5;  // of the wanted accuracy: where contacts switch, errors scatter about
                                     // their power law,
constexpr double grid_most = 0.8;    // and a pilot that shows more is not taken for good

/// The largest step not above `step` that divides the sample period or, beyond it, is a multiple of a quarter of it.
double fitted_to_samples(double step, double sample_rate_hz) {
    const double per_sample = 1 / (sample_rate_hz * step);
    constexpr double slack = 1e-9;
    if (per_sample >= 1 - slack) {
        return 1 / (sample_rate_hz * std::ceil(per_sample * (1 - slack)));
    }
    return std::floor(4 / per_sample * (1 + slack)) / (4 * sample_rate_hz);
}

double coarsest_step(const Scene& scene) {
    const Chain chain(scene);
    const Eigen::ArrayXd overlaps = expected_overlaps(chain, scene.drive);
    const double omega = fastest_frequency(chain, overlaps);
    const double by_drive = part_of_period_s(scene.drive, drive_periods);
    const double stable = largest_stable_step(chain, overlaps, *scene.numerics.integrator);
    return std::min({first_phase / omega, by_drive, stable / 2});
}

AdvisedStep advise_on_grid(const Scene& scene, ReferencePilot& reference) {
    const Integrator integrator = *scene.numerics.integrator;
    const double accuracy = asked_accuracy(scene.numerics);
    const double target = grid_safety * accuracy;
    const double bodies = static_cast<double>(reference.spheres()) + 1;
    const double first = coarsest_step(scene);
    StepAdvice advice;
    const auto trial_of = [&](double step) {
        ++advice.pilots;
        return reference.trial(integrator, fitted_to_samples(step, scene.output.sample_rate_hz));
    };
    const auto error_of = [accuracy](const Trial& trial) { return judged_error(trial, accuracy); };
    Trial trial = trial_of(first);
    double coarser_error = 0;
    double step = first;
    double taken = 0;
    for (int halvings = 0;
         error_of(trial) > target && halvings < max_halvings && taken < max_body_steps_together; ++halvings) {
        coarser_error = error_of(trial);
        step /= 2;
        trial = trial_of(step);
        taken += 2 * bodies * reference.duration_s() / step;
    }
    if (error_of(trial) > target && trial.error > chaotic_error) {
        trial = trial_of(first / 4);
    } else if (error_of(trial) <= target && std::isfinite(coarser_error) && coarser_error > error_of(trial)) {
        // between the step that is good enough and its double, which is not: a power law through both errors
        const double order = std::log2(coarser_error / error_of(trial));
        double growth = std::min(2.0, std::pow(target / std::max(error_of(trial), 1e-300), 1 / order));
        constexpr double worth_it = 1.1;
        constexpr int most_tries = 2;
        for (int tries = 0; tries < most_tries && growth > worth_it; ++tries) {
            Trial longer = trial_of(growth * step);
            if (error_of(longer) <= grid_most * accuracy) {
                trial = std::move(longer);
                break;
            }
            growth *= std::pow(target / error_of(longer), 1 / order);
        }
    }
    return {advice, std::move(trial)};
}

// Series

constexpr double aim = 0.3;     // of the wanted accuracy,
constexpr double least = 0.12;  // and the error below which a longer step is tried
constexpr int max_trials = 10;
constexpr double slope = 13;  // of log(error) over log(step), roughly

double rounded_down(double step) {
    const double unit = std::pow(10, std::floor(std::log10(step)) - 2);
    return std::floor(step / unit * (1 + 1e-12)) * unit;
}

/// The longest piece that a series may take. @param largest_stable_s of the chain in motion
double longest_piece(const Scene& scene, const Chain& chain, const Eigen::ArrayXd& expected,
                     double largest_stable_s) {
    return std::min({0.98 * largest_stable_s,
                     0.98 * largest_stable_step(chain, expected, *scene.numerics.integrator),
                     longest_for_drive(scene.drive)});
}

/// The longest step whose error lies in the window, by secants on the logarithms.
template <class TrialOf>
std::optional<Trial> longest_good(const TrialOf& trial_of, double accuracy, double first, double limit,
                                  double finest) {
    double step = first;
    double too_long = std::numeric_limits<double>::infinity();
    std::optional<Trial> best;
    for (int trials = 0; trials < max_trials && step >= finest; ++trials) {
        step = rounded_down(step);
        Trial trial = trial_of(step);
        const double error = judged_error(trial, accuracy);
        if (error > most * accuracy) {
            too_long = std::min(too_long, step);
        } else if (!best || step > best->step_s) {
            best.emplace(std::move(trial));
            if (error >= least * accuracy || step >= 0.97 * limit) {
                break;
            }
        }
        const double reached = best ? best->step_s : 0;
        const double ratio = std::clamp(aim * accuracy / std::max(error, 1e-300), 1e-6, 1e6);
        step = std::min(step * std::pow(ratio, 1 / slope), limit);
        if (step <= reached || step >= too_long) {
            step = std::sqrt(std::max(reached, too_long / 2) * too_long);
        }
    }
    return best;
}

/// @param largest_stable_s the largest stable step with the overlaps of the reference
AdvisedStep advise_series(const Scene& scene, ReferencePilot& reference, const Chain& chain,
                          double largest_stable_s) {
    const Integrator integrator = *scene.numerics.integrator;
    const double accuracy = asked_accuracy(scene.numerics);
    const Eigen::ArrayXd expected = expected_overlaps(chain, scene.drive);
    const double omega = fastest_frequency(chain, expected);
    const double limit = longest_piece(scene, chain, expected, largest_stable_s);
    const double finest = std::min(reference.step_s(), limit);
    StepAdvice advice;
    const auto trial_of = [&](double step) {
        ++advice.pilots;
        return reference.trial(integrator, step);
    };
    const auto step_for = [&](double tolerance) {
        return std::min(limit, SeriesSolver::phase_for(tolerance) / omega);
    };
    std::optional<Trial> best;
    if (reference.error() <= most * accuracy) {
        best = longest_good(trial_of, accuracy, step_for(accuracy / 30), limit, finest);
    }
    if (!best) {
        // nothing can be shown to be better than the reference: it is taken for as good as can be had, unless
        // no step makes a difference
        best.emplace(trial_of(rounded_down(finest)));
        if (best->error > chaotic_error) {
            best.emplace(trial_of(rounded_down(step_for(1e-6))));
        }
    }
    return {advice, std::move(*best)};
}

}  // namespace

double expected_piece(const Scene& scene, double tolerance) {
    const Chain chain(scene);
    const Eigen::ArrayXd expected = expected_overlaps(chain, scene.drive);
    const double limit = longest_piece(scene, chain, expected, std::numeric_limits<double>::infinity());
    return rounded_down(
        std::min(limit, SeriesSolver::phase_for(tolerance) / fastest_frequency(chain, expected)));
}

AdvisedStep advise(const Scene& scene, ReferencePilot& reference) {
    const Integrator integrator = *scene.numerics.integrator;
    const Chain chain(shortened(scene));
    const double largest_stable_s = largest_stable_step(chain, reference.peak_overlap(), integrator);
    AdvisedStep advised = is_series(integrator) ? advise_series(scene, reference, chain, largest_stable_s)
                                                : advise_on_grid(scene, reference);
    StepAdvice& advice = advised.advice;
    advice.accuracy = asked_accuracy(scene.numerics);
    advice.recommended_step_s = advised.trial.step_s;
    advice.estimated_error = advised.trial.error;
    advice.accuracy_met = advised.trial.error <= advice.accuracy;
    advice.largest_stable_step_s = largest_stable_s;
    advice.pilot_duration_s = reference.duration_s();
    return advised;
}

}  // namespace hertzline
