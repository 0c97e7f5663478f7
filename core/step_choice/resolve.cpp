#include "hertzline/resolve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "core/model/end.hpp"
#include "core/scene/scene_words.hpp"
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

ReferencePilot reference_for(const Scene& scene, const std::atomic<bool>* stop) {
    return {scene, scene.numerics.accuracy.value_or(default_accuracy), stop};
}

/// A given step asks for no accuracy, of a long chain pilots see the first spheres only, and an error that is large grows no more.
bool worth_estimating_longer(const Resolution& resolved) noexcept {
    return resolved.estimate_ends_early() && !resolved.step_set_by_scene &&
           resolved.scene.chain.spheres <= pilot_spheres && resolved.estimate->error < chaotic_error;
}

}  // namespace

Resolution::operator ResolvedScene() const {
    if (!faults.empty()) {
        throw std::invalid_argument("the scene cannot be simulated\n" + fault_text(faults));
    }
    return scene;
}

IntegratorChoice integrator_choice(const Scene& scene) noexcept {
    if (scene.numerics.integrator) {
        return {*scene.numerics.integrator, IntegratorReason::set_by_scene};
    }
    const double accuracy = scene.numerics.accuracy.value_or(default_accuracy);
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
    const Scene scene = with_poles(with_integrator(asked));
    return advise(scene, reference_for(scene, nullptr)).advice;
}

Resolution resolve(const Scene& asked, std::optional<double> run_s, const std::atomic<bool>* stop) {
    Resolution result;
    result.run_s = run_s;
    result.scene = asked;
    result.faults = validate(asked);
    if (result.faults.empty()) {
        result.faults = plate_faults(asked);
    }
    if (!result.faults.empty()) {
        return result;
    }
    result.scene = with_poles(with_integrator(asked));
    result.faults = response_faults(result.scene);
    if (!result.faults.empty()) {
        return result;
    }
    result.integrator_reason = integrator_choice(asked).reason;
    result.step_set_by_scene = asked.numerics.step_s.has_value();
    ReferencePilot reference = reference_for(result.scene, stop);
    AdvisedStep advised = advise(result.scene, reference);
    result.advice = advised.advice;
    result.pilots = ReferencePilot::pilots + advised.advice.pilots;
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
    } else if (*numerics.step_s > result.advice.largest_stable_step_s) {
        result.faults.push_back(beyond_stability(*numerics.step_s, result.advice));
        return result;
    } else {
        trial = reference.affordable_trial(*numerics.integrator, *numerics.step_s);
        result.pilots += trial ? 1 : 0;
    }
    const double burst_s = result.scene.drive.cycles / result.scene.drive.frequency_hz;
    result.steps_per_burst = burst_s * (trial ? trial->steps_per_s : 1 / *numerics.step_s);
    if (trial) {
        ErrorEstimate estimate = reference.estimate(*trial, run_s);
        estimate.error += pole_error(result.scene);
        if (std::isfinite(estimate.error)) {
            result.estimate = estimate;
            result.seen = trial->pilot.seen(estimate.error);
        }
    }
    if (worth_estimating_longer(result)) {
        const ErrorEstimate found = estimate_of_run(result.scene, *run_s, stop);
        result.estimate->error = std::max(result.estimate->error, found.error);
        result.estimate->over_s = std::max(result.estimate->over_s, std::min(*run_s, found.over_s));
    }
    return result;
}

Resolution resolve(const Scene& scene, const std::atomic<bool>* stop) {
    return resolve(scene, scene.output.duration_s, stop);
}

}  // namespace hertzline
