#include "core/numerics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/pilot.hpp"
#include "core/series_solver.hpp"
#include "core/stability.hpp"

namespace hertzline {

namespace {

constexpr std::int64_t register_spheres = 30;  // four AVX-512 registers
constexpr std::int64_t pilot_spheres = 128;    // what a longer chain does is decided near the horn
constexpr double bursts_watched = 1.5;         // the chain rings on after the burst
constexpr double chaotic =
    0.05;  // an error that shorter steps do not bring below this is no truncation error

double watched_s(const Drive& drive) noexcept {
    return bursts_watched * drive.cycles / drive.frequency_hz;
}

Scene shortened(Scene scene) {
    scene.chain.spheres = std::min(scene.chain.spheres, pilot_spheres);
    return scene;
}

// --- steps on a grid: halved until two successive ones agree
// --------------------------------------------------

constexpr double most_body_steps = 1e6;           // of the coarsest pilot,
constexpr double most_body_steps_together = 3e7;  // and of all of them: about a second at worst
constexpr double first_phase = 0.6;               // omega h of the coarsest pilot: surely stable
constexpr double drive_periods = 1.0 / 20;        // and it resolves the drive
constexpr int most_halvings = 8;
constexpr double grid_safety = 0.5;  // of the wanted accuracy: where contacts switch, errors scatter about
                                     // their power law

/// The largest step not above `step` that divides the sample period or, beyond it, is a multiple of a quarter
/// of it.
double fitted_to_samples(double step, double sample_rate_hz) {
    const double per_sample = 1 / (sample_rate_hz * step);
    constexpr double slack = 1e-9;
    if (per_sample >= 1 - slack) {
        return 1 / (sample_rate_hz * std::ceil(per_sample * (1 - slack)));
    }
    return std::floor(4 / per_sample * (1 + slack)) / (4 * sample_rate_hz);
}

/// Sampled once a step of the coarsest pilot, the output left out: it jumps where a contact switches.
PilotPlan plan_on_grid(const Scene& asked, double first_step) {
    PilotPlan plan{shortened(asked), 0};
    const double affordable = most_body_steps / static_cast<double>(plan.scene.chain.spheres + 1);
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

StepAdvice advise_on_grid(const Scene& scene) {
    const Integrator integrator = *scene.numerics.integrator;
    const double target = grid_safety * scene.numerics.accuracy.value_or(default_accuracy);
    const double first = coarsest_step(scene);
    const PilotPlan plan = plan_on_grid(scene, first);
    const auto bodies = static_cast<std::size_t>(plan.scene.chain.spheres) + 1;

    StepAdvice advice;
    advice.pilot_duration_s = static_cast<double>(plan.samples) * first;
    double step = first;
    double coarser_error = 0;
    double error = 0;
    double taken = 0;
    Pilot coarse = fly(plan, integrator, step);
    for (int halvings = 0;; ++halvings) {
        Pilot fine = fly(plan, integrator, step / 2);
        coarser_error = error;
        // what remains at half the step is at most a third of the difference, by the lowest order in use
        // (two)
        error = largest_difference(coarse, fine) * 4 / 3;
        coarse = std::move(fine);
        taken += 2 * static_cast<double>(plan.samples * bodies) * std::exp2(halvings + 1);
        if (error <= target || halvings == most_halvings || taken > most_body_steps_together) {
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
    } else if (!advice.accuracy_met && error > chaotic) {
        step = first / 4;
    }
    advice.recommended_step_s = fitted_to_samples(step, scene.output.sample_rate_hz);
    advice.estimated_error = error;
    return advice;
}

// --- series: compared with one that is as good as exact
// -------------------------------------------------------

constexpr double series_drive_periods = 0.11;  // the longest step: the horn's series reaches that far
constexpr double aim = 0.3;                    // of the wanted accuracy
constexpr double most = 0.6;                   // of it that a pilot may show,
constexpr double least = 0.12;                 // and below which a longer step is tried
constexpr int most_trials = 10;
constexpr double slope = 13;  // of log(error) over log(step), roughly

struct Trial {
    double step_s;
    double error;
};

double rounded_down(double step) {
    const double unit = std::pow(10, std::floor(std::log10(step)) - 2);
    return std::floor(step / unit * (1 + 1e-12)) * unit;
}

/// Sampled as the scene is, so that samples beside a contact's switching count as they will.
PilotPlan plan_of_series(const Scene& asked, double longest_step) {
    constexpr double most_samples = 40e3;
    constexpr double most_pieces = 20e3;
    constexpr double per_period = 16;
    constexpr double least_samples = 16;
    const double watched = std::min(watched_s(asked.drive), most_pieces * longest_step);
    PilotPlan plan{shortened(asked), 0};
    const double affordable = most_samples * 7 / static_cast<double>(plan.scene.chain.spheres + 1) / watched;
    double& rate = plan.scene.output.sample_rate_hz;
    rate = std::max(
        {std::min(rate, affordable), per_period * asked.drive.frequency_hz, least_samples / watched});
    plan.samples =
        static_cast<std::size_t>(std::clamp(std::ceil(watched * rate), least_samples, most_samples));
    return plan;
}

StepAdvice advise_series(const Scene& scene) {
    const Integrator integrator = *scene.numerics.integrator;
    const double accuracy = scene.numerics.accuracy.value_or(default_accuracy);
    const Chain chain(shortened(scene));
    const double omega = fastest_frequency(chain, expected_overlaps(chain, scene.drive));
    const double by_drive = series_drive_periods / scene.drive.frequency_hz;
    const auto longest = [&](const Eigen::ArrayXd& overlaps) {
        return largest_stable_step(chain, overlaps, integrator);
    };
    const PilotPlan plan = plan_of_series(scene, longest(expected_overlaps(chain, scene.drive)));
    const double stable_at_rest = 0.98 * longest(expected_overlaps(chain, scene.drive));
    const double exact_step = std::min({SeriesSolver::phase_for(1e-13) / omega, by_drive, stable_at_rest});
    const Pilot exact = fly(plan, Integrator::taylor12, exact_step);

    StepAdvice advice;
    advice.pilot_duration_s = static_cast<double>(plan.samples) / plan.scene.output.sample_rate_hz;
    advice.largest_stable_step_s = longest(exact.peak_overlap);
    const double limit = std::min({0.98 * advice.largest_stable_step_s, stable_at_rest, by_drive});
    // the longest step whose error lies in the window, by secants on the logarithms
    double step = std::min(limit, SeriesSolver::phase_for(accuracy / 30) / omega);
    double too_long = std::numeric_limits<double>::infinity();
    Trial best{0, std::numeric_limits<double>::infinity()};
    for (int trial = 0; trial < most_trials && step >= exact_step; ++trial) {
        step = rounded_down(step);
        const double error = largest_difference(fly(plan, integrator, step), exact);
        if (error > most * accuracy) {
            too_long = std::min(too_long, step);
        } else if (step > best.step_s) {
            best = {step, error};
            if (error >= least * accuracy || step >= 0.97 * limit) {
                break;
            }
        }
        const double ratio = std::clamp(aim * accuracy / std::max(error, 1e-300), 1e-6, 1e6);
        step = std::min(step * std::pow(ratio, 1 / slope), limit);
        if (step <= best.step_s || step >= too_long) {
            step = std::sqrt(std::max(best.step_s, too_long / 2) * too_long);
        }
    }
    advice.accuracy_met = best.step_s > 0;
    if (!advice.accuracy_met) {
        // nothing can be shown to be better than the reference: it is taken for as good as can be had, unless
        // no step makes a difference
        const double error = largest_difference(fly(plan, integrator, rounded_down(exact_step)), exact);
        const double step_of_chaos = std::min(limit, SeriesSolver::phase_for(1e-6) / omega);
        best = {rounded_down(error > chaotic ? step_of_chaos : exact_step), error};
    }
    advice.recommended_step_s = best.step_s;
    advice.estimated_error = best.error;
    return advice;
}

bool is_series(Integrator integrator) noexcept {
    return integrator == Integrator::taylor8 || integrator == Integrator::taylor12;
}

}  // namespace

Scene with_integrator(Scene scene) {
    if (!scene.numerics.integrator) {
        constexpr double high_accuracy = 1e-6;
        const bool high = scene.numerics.accuracy.value_or(default_accuracy) < high_accuracy;
        const Integrator series = high ? Integrator::taylor12 : Integrator::taylor8;
        scene.numerics.integrator = scene.chain.spheres <= register_spheres ? series : Integrator::leapfrog;
    }
    return scene;
}

StepAdvice advise_step(const Scene& asked) {
    const Scene scene = with_integrator(asked);
    return is_series(*scene.numerics.integrator) ? advise_series(scene) : advise_on_grid(scene);
}

Resolved resolved(const Scene& asked) {
    Resolved result{with_integrator(asked), advise_step(asked), {}};
    Numerics& numerics = result.scene.numerics;
    numerics.accuracy.reset();
    if (!numerics.step_s) {
        numerics.step_s = result.advice.recommended_step_s;
        return result;
    }
    const double limit = result.advice.largest_stable_step_s;
    if (*numerics.step_s > limit) {
        std::array<char, 64> found{};
        std::array<char, 128> allowed{};
        std::snprintf(found.data(), found.size(), "%.9g", *numerics.step_s);
        std::snprintf(allowed.data(), allowed.size(),
                      "at most %.4g s, the stability limit in this scene (recommended: %.4g s)", limit,
                      result.advice.recommended_step_s);
        result.faults.push_back({"numerics.step_s", found.data(), allowed.data()});
    }
    return result;
}

}  // namespace hertzline
