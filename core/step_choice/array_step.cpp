#include "core/step_choice/array_step.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/array/array_solver.hpp"
#include "core/model/chain.hpp"
#include "core/model/drive.hpp"
#include "core/model/end.hpp"
#include "core/scene/elements.hpp"
#include "core/step_choice/finer_run.hpp"
#include "core/step_choice/step_advice.hpp"

namespace hertzline {

namespace {

constexpr double wanted_share = 0.7;  // of the accuracy, by the estimate
constexpr double of_a_chain = 0.3;    // the sounds of several may cancel, their errors do not

/// The chains that differ in more than their delays.
struct DistinctChain {
    Scene scene;
    std::size_t element;  ///< the first that is like it
};
std::vector<DistinctChain> distinct_chains(const Scene& scene) {
    std::vector<DistinctChain> chains;
    for (std::size_t i = 0; i < chains_of(scene); ++i) {
        Scene one = element_scene(scene, i);
        one.drive.start_s = scene.drive.start_s;
        one.output.points_m.clear();
        const auto alike = [&one](const DistinctChain& chain) { return chain.scene == one; };
        if (std::none_of(chains.begin(), chains.end(), alike)) {
            chains.push_back({std::move(one), i});
        }
    }
    return chains;
}

/// Over which a stream is judged: the latest burst and its sound, and a second period where there is one.
double judged_s(const Scene& scene) {
    const double ring_s = 300e-6;
    return scene.drive.kind == DriveKind::tone && scene.drive.repetition_hz > 0
               ? 2 / scene.drive.repetition_hz
               : first_burst_end_s(scene) + ring_s;
}

/// As many poles as let the discs answer each other as exactly as is wanted.
std::int64_t poles_of_discs(const Scene& asked, std::int64_t poles, double accuracy) {
    constexpr std::int64_t most = 64;
    constexpr std::int64_t more = 4;
    constexpr double share = 0.7;
    if (asked.array.coupling == Coupling::none || chains_of(asked) < 2) {
        return poles;
    }
    const PlateParameters parameters = plate_parameters(element_scene(asked, 0));
    while (poles < most &&
           mode_response(*plate_response(parameters, static_cast<int>(poles)))->error > share * accuracy) {
        poles += more;
    }
    return poles;
}

enum class Choice { guessed, by_pilots };

/// The shortest step and the most poles that any chain needs alone. @param choice of each chain's step
Resolution of_chains(const Scene& asked, Choice choice, const std::atomic<bool>* stop) {
    Resolution result;
    result.scene = with_integrator(asked);
    result.asked = asked.numerics;
    result.integrator_reason = integrator_choice(asked).reason;
    result.step_set_by_scene = asked.numerics.step_s.has_value();
    result.advice.accuracy = asked_accuracy(asked.numerics);
    std::optional<double> step = asked.numerics.step_s;
    std::optional<std::int64_t> poles = asked.numerics.poles;
    for (auto& [chain, element] : distinct_chains(asked)) {
        if (!asked.numerics.step_s) {
            chain.numerics.accuracy = std::max(of_a_chain * result.advice.accuracy, 1e-15);
        }
        result.faults = model_faults(chain);
        if (result.faults.empty() && has_samples(asked.drive)) {
            if (auto late = late_burst_fault(asked, burst_duration_s(asked.drive))) {
                result.faults = {*std::move(late)};
                return result;
            }
        }
        const bool guess = result.faults.empty() && choice == Choice::guessed;
        std::optional<Resolution> one = guess ? resolve_unmeasured(chain) : std::nullopt;
        if (!one && result.faults.empty()) {
            one = resolve(chain, std::nullopt, stop);
            result.faults = one->faults;
            result.pilots += one->pilots;
        }
        if (!result.faults.empty()) {
            for (Fault& fault : result.faults) {
                fault.found += ", of element " + std::to_string(element + 1) + " of the array";
            }
            return result;
        }
        const Numerics& of_chain = one->scene.numerics;
        step = std::min(step.value_or(*of_chain.step_s), *of_chain.step_s);
        poles = std::max(poles.value_or(0), of_chain.poles.value_or(0));
    }
    Numerics& numerics = result.scene.numerics;
    numerics.step_s = step;
    numerics.poles = asked.numerics.poles ? poles : poles_of_discs(asked, *poles, result.advice.accuracy);
    numerics.accuracy.reset();
    return result;
}

/// The array with the chains' step, or a shorter one that keeps the accuracy.
Resolution estimated(const Scene& asked, Choice choice, double over_s, const std::atomic<bool>* stop,
                     std::size_t threads) {
    Resolution result = of_chains(asked, choice, stop);
    if (!result.faults.empty()) {
        return result;
    }
    for (int tries = 0; tries < max_tries; ++tries) {
        Resolution tried = result;
        if (tries > 0) {
            auto shorter = with_shorter_step(result, result.estimate->error);
            if (!shorter) {
                break;
            }
            tried = *std::move(shorter);
            if (!asked.numerics.poles && tried.scene.numerics.poles) {
                constexpr std::int64_t more = 8;
                tried.scene.numerics.poles = std::min<std::int64_t>(64, *tried.scene.numerics.poles + more);
            }
        }
        const auto [found, seen] = estimate_of_run(with_few_points(tried.scene), over_s, stop, threads);
        result.pilots += 2;
        if (tries > 0 && !(found.error < result.estimate->error)) {
            break;
        }
        tried.pilots = result.pilots;
        result = std::move(tried);
        result.estimate = found;
        result.seen = seen;
        if (found.error <= wanted_share * result.advice.accuracy || result.step_set_by_scene ||
            (stop != nullptr && *stop)) {
            break;
        }
    }
    return result;
}

}  // namespace

Resolution resolve_array(const Scene& asked, std::optional<double> run_s, const std::atomic<bool>* stop,
                         std::size_t threads) {
    const double over_s = run_s.value_or(judged_s(asked));
    Resolution result = estimated(asked, Choice::guessed, over_s, stop, threads);
    if (result.faults.empty() && result.misses_accuracy()) {  // as do motions that amplify errors
        Resolution better = estimated(asked, Choice::by_pilots, over_s, stop, threads);
        better.pilots += result.pilots;
        if (!better.faults.empty() || better.estimate->error < result.estimate->error) {
            result = std::move(better);
        }
    }
    result.run_s = run_s;
    if (!result.faults.empty()) {
        return result;
    }
    StepAdvice& advice = result.advice;
    advice.recommended_step_s = *result.scene.numerics.step_s;
    advice.estimated_error = result.estimate->error;
    advice.accuracy_met = result.estimate->error <= advice.accuracy;
    advice.pilots = result.pilots;
    advice.pilot_duration_s = over_s;
    result.steps_per_burst = burst_duration_s(asked.drive) / *result.scene.numerics.step_s *
                             static_cast<double>(array_members(asked).size());
    return result;
}

}  // namespace hertzline
