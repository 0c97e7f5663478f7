#include "core/step_choice/resolve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/scene/scene_words.hpp"

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

/// One more pilot, with the step in use.
void expect(ResolvedScene& result, const ReferencePilot& reference) {
    const Numerics& numerics = result.scene.numerics;
    const Drive& drive = result.scene.drive;
    const double burst_s = drive.cycles / drive.frequency_hz;
    result.steps_per_burst = burst_s / *numerics.step_s;
    if (const auto trial = reference.affordable_trial(*numerics.integrator, *numerics.step_s)) {
        ++result.pilots;
        result.steps_per_burst = burst_s * trial->steps_per_s;
        if (std::isfinite(trial->error)) {
            result.estimated_error = trial->error;
        }
    }
}

}  // namespace

IntegratorChoice integrator_choice(const Scene& scene) noexcept {
    if (scene.numerics.integrator) {
        return {*scene.numerics.integrator, IntegratorReason::set_by_scene};
    }
    if (scene.chain.spheres > short_chain_spheres) {
        return {Integrator::leapfrog, IntegratorReason::long_chain};
    }
    if (scene.numerics.accuracy.value_or(default_accuracy) < high_accuracy) {
        return {Integrator::taylor12, IntegratorReason::high_accuracy};
    }
    return {Integrator::taylor8, IntegratorReason::short_chain};
}

Scene with_integrator(Scene scene) {
    scene.numerics.integrator = integrator_choice(scene).integrator;
    return scene;
}

StepAdvice advise_step(const Scene& asked) {
    const Scene scene = with_integrator(asked);
    return is_series(*scene.numerics.integrator) ? advise_series(scene, ReferencePilot(scene))
                                                 : advise_on_grid(scene);
}

ResolvedScene resolve(const Scene& asked) {
    ResolvedScene result;
    result.scene = with_integrator(asked);
    result.integrator_reason = integrator_choice(asked).reason;
    result.step_set_by_scene = asked.numerics.step_s.has_value();
    const ReferencePilot reference(result.scene);
    Numerics& numerics = result.scene.numerics;
    result.advice = is_series(*numerics.integrator) ? advise_series(result.scene, reference)
                                                    : advise_on_grid(result.scene);
    result.pilots = ReferencePilot::pilots + result.advice.pilots;
    if (numerics.rest_tolerance > 0 && !is_series(*numerics.integrator)) {
        result.faults.push_back({"numerics.rest_tolerance",
                                 "the integrator " + std::string(word(*numerics.integrator)),
                                 "0 unless the integrator is taylor8 or taylor12"});
    }
    numerics.accuracy.reset();
    if (!result.step_set_by_scene) {
        numerics.step_s = result.advice.recommended_step_s;
    } else if (*numerics.step_s > result.advice.largest_stable_step_s) {
        result.faults.push_back(beyond_stability(*numerics.step_s, result.advice));
        return result;
    }
    expect(result, reference);
    return result;
}

}  // namespace hertzline
