#include "hertzline/resolve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "core/integrators/stability.hpp"
#include "core/model/drive.hpp"
#include "core/model/end.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "core/step_choice/array_step.hpp"
#include "core/step_choice/finer_run.hpp"
#include "core/step_choice/step_advice.hpp"

namespace hertzline {

namespace {

Fault beyond_stability(double step_s, const StepAdvice& advice) {
    std::array<char, 64> found{};
    std::array<char, 128> allowed{};
    std::snprintf(found.data(), found.size(), "%.9g", step_s);
    std::snprintf(allowed.data(), allowed.size(),
                  "at most %.4g s, the stability limit in this scene (recommended: %.4g s)",
                  advice.largest_stable_step_s, advice.recommended_step_s);
    return {"numerics.step_s", found.data(), allowed.data()};
}

/// The bound of the steps of a live drive whose horn resonates, which its pilots take for rigid.
void keep_stable_with_horn(Resolution& result) {
    if (result.scene.drive.horn != HornModel::resonator) {
        return;
    }
    constexpr double safety = 0.98;
    const Chain chain(shortened(result.scene));
    const double largest = safety * largest_stable_step(chain, expected_overlaps(chain, result.scene.drive),
                                                        *result.scene.numerics.integrator);
    StepAdvice& advice = result.advice;
    advice.largest_stable_step_s = std::min(advice.largest_stable_step_s, largest);
    advice.recommended_step_s = std::min(advice.recommended_step_s, largest);
    double& step_s = *result.scene.numerics.step_s;
    if (step_s > largest && result.step_set_by_scene) {
        result.faults.push_back(beyond_stability(step_s, advice));
    } else {
        step_s = std::min(step_s, largest);
    }
}

/// The step that a scene needs is below the bound of numerics.step_s, which the scene does not give.
Fault too_stiff(double step_s) {
    const SceneKey key = scene_key_named(Scene(), "numerics.step_s").value();
    return {"chain", "spheres so small, stiff or damped that a step is " + number_text(step_s) + " s",
            "a scene whose steps are " + number_text(key.range.min) + " s or more"};
}

/// A reference that is good enough to judge the accuracy, or a given step, if shorter pieces can make it so. @throws std::bad_alloc
/// @param result counts the pilots of those that were not good enough
ReferencePilot reference_for(const Scene& scene, Resolution& result, const std::atomic<bool>* stop) {
    constexpr double of_a_given_step = 1e-10;  // the error that it may have
    constexpr double helps = 0.5;              // amplified rounding does not fall
    const double accuracy = asked_accuracy(scene.numerics);
    const double good = scene.numerics.step_s ? of_a_given_step : accuracy / 2;
    double piece_error = piece_error_for(accuracy);
    ReferencePilot reference(scene, accuracy, piece_error, stop);
    result.pilots = ReferencePilot::pilots;
    while (reference.watched_error() > good && reference.watched_error() < chaotic_error &&
           piece_error > finest_piece_error) {
        piece_error = std::max(piece_error / 10, finest_piece_error);
        ReferencePilot other(scene, accuracy, piece_error, stop);
        result.pilots += ReferencePilot::pilots;
        const bool better = other.watched_error() < helps * reference.watched_error();
        if (better) {
            std::swap(reference, other);
        }
        result.pilot_body_steps += other.body_steps();
        if (!better) {
            break;
        }
    }
    return reference;
}

/// How long the chain rests before the horn begins [s]; 0 where it moves from the start.
double wait_s(const Scene& scene) {
    const Drive& drive = scene.drive;
    const bool begins_later =
        drive.start_s > 0 && (drive.kind == DriveKind::tone || drive.kind == DriveKind::file);
    const bool rests =
        begins_later && scene.chain.impact_velocity_m_per_s == 0 && Chain(shortened(scene)).balanced();
    return rests ? drive.start_s : 0;
}

/// The scene for pilots, which would watch a chain at rest else.
Scene without_wait(Scene scene) {
    scene.drive.start_s -= wait_s(scene);
    return scene;
}

/// A given step asks for no accuracy, of a long chain pilots see the first spheres only, and an error that is large grows no more.
bool worth_estimating_longer(const Resolution& resolved) noexcept {
    return resolved.estimate_ends_early() && !resolved.step_set_by_scene &&
           resolved.scene.chain.spheres <= pilot_spheres && resolved.estimate->error < chaotic_error;
}

/// A pilot with the step in use, which sleeps as the run does.
std::optional<Trial> trial_of_step(const Scene& scene, ReferencePilot& reference) {
    const Numerics& numerics = scene.numerics;
    const double rest_tolerance = is_series(*numerics.integrator) ? numerics.rest_tolerance : 0;
    return reference.affordable_trial(*numerics.integrator, *numerics.step_s, rest_tolerance);
}

/// Estimates the error of the step in use over the run. @param trial with that step, if one is affordable
void estimate(Resolution& result, ReferencePilot& reference, std::optional<Trial>& trial,
              const std::atomic<bool>* stop) {
    const Drive& drive = result.scene.drive;
    result.steps_per_burst =
        burst_duration_s(drive) * (trial ? trial->steps_per_s : 1 / *result.scene.numerics.step_s);
    result.estimate.reset();
    if (!trial) {
        return;
    }
    const double waits_s = wait_s(result.scene);
    ErrorEstimate found{.error = 0, .over_s = result.run_s.value_or(0)};  // of a run that ends in the wait
    if (!result.run_s || *result.run_s > waits_s) {
        found =
            reference.estimate(*trial, result.run_s ? std::optional(*result.run_s - waits_s) : std::nullopt);
        found.over_s += waits_s;
    }
    const Scene& used = result.scene;
    const Scene other = with_another_fit(used, asked_accuracy(result.asked));
    const double of_reference = reference.fit_amplification() * std::min(pole_error(other), pole_error(used));
    found.error = std::max(found.error, least_error) + of_reference;
    if (!std::isfinite(found.error)) {
        return;
    }
    result.estimate = found;
    result.seen = trial->pilot.seen(found.error);
    if (worth_estimating_longer(result)) {
        const ErrorEstimate longer = estimate_of_run(result.scene, *result.run_s, stop).estimate;
        result.estimate->error = std::max(found.error, longer.error);
        result.estimate->over_s = std::max(found.over_s, std::min(*result.run_s, longer.over_s));
    }
}

/// Shortens the step of a series whose error is within the accuracy as far as the step was chosen, but outgrows it within the run.
void shorten(Resolution& result, ReferencePilot& reference, const std::atomic<bool>* stop) {
    constexpr double helps = 0.7;  // of the error before
    for (int tries = 1; tries < max_tries && result.estimate && result.misses_accuracy(); ++tries) {
        std::optional<Resolution> shorter = with_shorter_step(result, result.estimate->error);
        if (!shorter) {
            return;
        }
        std::optional<Trial> trial = trial_of_step(shorter->scene, reference);
        estimate(*shorter, reference, trial, stop);
        ++result.pilots;
        if (!shorter->estimate || shorter->estimate->error > helps * result.estimate->error) {
            return;
        }
        shorter->pilots = result.pilots;
        shorter->advice.recommended_step_s = trial->step_s;
        shorter->advice.estimated_error = trial->error;
        result = *std::move(shorter);
    }
}

}  // namespace

Resolution::operator ResolvedScene() const {
    if (!faults.empty()) {
        throw std::invalid_argument("the scene cannot be simulated\n" + fault_text(faults));
    }
    return scene;
}

Scene Resolution::requested() const {
    Scene requested = scene;
    requested.numerics = asked;
    return requested;
}

IntegratorChoice integrator_choice(const Scene& scene) noexcept {
    if (scene.numerics.integrator) {
        return {*scene.numerics.integrator, IntegratorReason::set_by_scene};
    }
    const double accuracy = asked_accuracy(scene.numerics);
    if (accuracy < high_accuracy) {
        return {Integrator::taylor12, IntegratorReason::high_accuracy};
    }
    return {Integrator::taylor8, IntegratorReason::fastest};
}

Scene with_integrator(Scene scene) {
    scene.numerics.integrator = integrator_choice(scene).integrator;
    return scene;
}

Scene with_poles(Scene scene) {
    if (const int poles = plate_poles(scene); poles > 0) {
        scene.numerics.poles = poles;
    }
    return scene;
}

double pole_error(const Scene& scene) {
    if (plate_poles(scene) == 0) {
        return 0;
    }
    return plate_response(plate_parameters(scene), plate_poles(scene))->fit_error();
}

StepAdvice advise_step(const Scene& asked) {
    const Scene scene = with_poles(with_integrator(as_declared(asked)));
    Resolution counted;
    ReferencePilot reference = reference_for(without_wait(scene), counted, nullptr);
    return advise(without_wait(scene), reference).advice;
}

Resolution resolve(const Scene& given, std::optional<double> run_s, const std::atomic<bool>* stop,
                   std::size_t threads) {
    const Scene asked = with_live_drive(given);
    Resolution result;
    result.run_s = run_s;
    result.scene = asked;
    result.asked = asked.numerics;
    result.faults = validate(asked);
    if (result.faults.empty()) {
        if (run_s && !(*run_s > 0 && std::isfinite(*run_s))) {
            throw std::invalid_argument("run_s: found " + number_text(*run_s) +
                                        ", allowed: a positive number of seconds");
        }
        if (is_array(asked)) {
            return resolve_array(asked, run_s, stop, threads);
        }
        result.faults = model_faults(asked);
    }
    if (auto fault = awaited_samples_fault(asked.drive); fault && result.faults.empty() && run_s) {
        result.faults.push_back(*std::move(fault));
    }
    if (!result.faults.empty()) {
        return result;
    }
    if (asked.drive.kind == DriveKind::live) {
        result = resolve(as_declared(asked), run_s, stop);
        result.scene.drive = asked.drive;
        if (result.faults.empty()) {
            keep_stable_with_horn(result);
        }
        if (result.faults.empty()) {
            result.scene = with_latency(std::move(result.scene));
        }
        return result;
    }
    result.scene = with_poles(with_integrator(asked));
    result.faults = response_faults(result.scene);
    if (!result.faults.empty()) {
        return result;
    }
    result.integrator_reason = integrator_choice(asked).reason;
    result.step_set_by_scene = asked.numerics.step_s.has_value();
    ReferencePilot reference = reference_for(without_wait(result.scene), result, stop);
    if (reference.needs_finer_fit() && !asked.numerics.poles) {
        reference.take_finer_fit();
        result.scene = with_another_fit(std::move(result.scene), asked_accuracy(asked.numerics));
    }
    AdvisedStep advised = advise(without_wait(result.scene), reference);
    result.advice = advised.advice;
    result.advice.pilot_duration_s += wait_s(result.scene);
    result.pilots += advised.advice.pilots;
    Numerics& numerics = result.scene.numerics;
    if (numerics.rest_tolerance > 0 && !is_series(*numerics.integrator)) {
        result.faults.push_back({"numerics.rest_tolerance",
                                 "the integrator " + std::string(word(*numerics.integrator)),
                                 "0 unless the integrator is taylor8 or taylor12"});
    }
    numerics.accuracy.reset();
    std::optional<Trial> trial;
    if (!result.step_set_by_scene) {
        numerics.step_s = result.advice.recommended_step_s;
        trial.emplace(std::move(advised.trial));
        if (!validate(result.scene).empty()) {
            result.faults.push_back(too_stiff(*numerics.step_s));
            return result;
        }
    } else if (*numerics.step_s > result.advice.largest_stable_step_s) {
        result.faults.push_back(beyond_stability(*numerics.step_s, result.advice));
        return result;
    }
    if (result.step_set_by_scene || numerics.rest_tolerance > 0) {
        trial = trial_of_step(result.scene, reference);
        result.pilots += trial ? 1 : 0;
    }
    estimate(result, reference, trial, stop);
    if (result.advice.accuracy_met && is_series(*numerics.integrator)) {
        shorten(result, reference, stop);
    }
    result.pilot_body_steps += reference.body_steps();
    return result;
}

Resolution resolve(const Scene& scene) {
    return resolve(scene, scene.output.duration_s);
}

}  // namespace hertzline
