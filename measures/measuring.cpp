#include "measures/measuring.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/array/array_solver.hpp"
#include "core/model/chain.hpp"
#include "core/model/validity.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/unused_keys.hpp"
#include "measures/record_warnings.hpp"
#include "measures/run.hpp"

namespace hertzline::measures {

namespace {

/// When the pressure at the first point first exceeds half of its peak [s].
std::optional<double> first_arrival_s(const Run& run) {
    const double half = 0.5 * peak_of(run.p_first);
    const auto first = std::ranges::find_if(run.p_first, [half](double p) { return std::abs(p) > half; });
    return first == run.p_first.end() ? std::nullopt
                                      : std::optional(static_cast<double>(first - run.p_first.begin()) /
                                                      run.scene().output.sample_rate_hz);
}

/// The peak of the pressure that the middle element alone makes at the first point [Pa].
std::optional<double> peak_of_one_alone(const Scene& scene, const std::atomic<bool>* stop) {
    const std::size_t middle = middle_element(scene);
    Scene one = element_scene(scene, middle);
    one.output.points_m.resize(1);
    one.output.points_m[0][0] -= scene.array.x_m[middle];
    one.output.points_m[0][1] -= scene.array.y_m[middle];
    Simulation simulation(one, {.taps = Tap::p_points, .ledger = LedgerKeeping::off, .stop = stop});
    Samples block = simulation.make_samples(block_of_run(one, Tap::p_points));
    double peak = 0;
    for (auto left = static_cast<std::size_t>(rows_of_run(one)); left > 0; left -= block.count) {
        if (simulation.advance(block, std::min(block.capacity(), left)) != Status::running) {
            return std::nullopt;
        }
        peak = std::max(peak, peak_of(block[Tap::p_points]));
    }
    return peak;
}

/// Returns the levels of v_out's harmonics with the jumps of its formula over those without [dB]; empty without a plate.
std::vector<double> switching_of(SpectrumAnalyser& analyser, const Run& run) {
    if (run.v_out_smooth.empty()) {
        return {};
    }
    const SpectrumSummary& v_out = run.taps.front().spectrum;
    return level_differences_db(v_out.harmonics, analyser.harmonics(run.v_out_smooth, v_out.fundamental_hz));
}

void append(Warnings& warnings, const Warnings& more) {
    warnings.insert(warnings.end(), more.begin(), more.end());
}

}  // namespace

void measure(Run& run, SpectrumAnalyser* analyser, std::optional<double> band_from_hz,
             const std::atomic<bool>* stop) {
    const Scene& scene = run.resolved.scene;
    if (analyser != nullptr) {
        for (TapRecord& tap : run.taps) {
            tap.spectrum = analyser->analyse(tap.values, scene.drive.frequency_hz, band_from_hz);
        }
        run.switching_db = switching_of(*analyser, run);
    }
    const std::vector<double>& v_out = run.taps.front().values;
    run.ringing_ratio = ringing_ratio(scene, v_out);
    run.first_arrival_s = first_arrival_s(run);
    if (scene.array.x_m.size() > 1 && !run.p_first.empty()) {
        run.alone_p_pa = peak_of_one_alone(scene, stop);
        run.stopped = run.stopped || (stop != nullptr && *stop);
    }
    append(run.warnings, record_warnings(scene, v_out, run.rung_down_s));
    append(run.warnings, late_sound_warnings(scene));
    if (constexpr double far_off = 0.1; !(run.energy_residual <= far_off)) {
        run.warnings.push_back(
            fmt::format("the ledger of energy does not close: energy_residual is {:.2g} of the energy that "
                        "came and went, so the motion is not "
                        "that of the scene; a shorter numerics.step_s, or another numerics.integrator, shows "
                        "whether it changes",
                        run.energy_residual));
    }
    append(run.warnings, band_warnings("v_out", run.taps.front().spectrum));
    append(run.warnings, switching_warnings(run.switching_db));
    for (const TapRecord& tap : std::span(run.taps).subspan(1)) {
        append(run.warnings, band_warnings(row_of(tap.tap).name, tap.spectrum));
    }
    append(run.warnings, validity_warnings(run.load));
    if (auto bent = bending_warning(run.scene(), run.deflection_m)) {
        run.warnings.push_back(*std::move(bent));
    }
    if (run.strength_warning) {
        run.warnings.push_back(*run.strength_warning);
    }
}

Warnings scene_warnings(const Resolution& resolved) {
    return scene_warnings(resolved, Chain(element_scene(resolved.scene, 0)));
}

/// A warning's words: those of several elements may differ in numbers.
static std::string without_numbers(std::string text) {
    std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == 'e'; });
    return text;
}

/// The validity of each chain of an array. Where elements differ in numbers alone, one sentence has the first of them.
static Warnings warnings_of_elements(const Scene& scene, const Chain& first_chain) {
    struct Told {
        std::string text;
        std::size_t element = 0;  ///< the first one
        std::size_t last = 0;     ///< the last one
        std::size_t others = 0;   ///< that have it, too
        bool is_same = true;      ///< in numbers
    };
    std::vector<Told> all;
    for (std::size_t element = 0; element < chains_of(scene); ++element) {
        const Scene one = element_scene(scene, element);
        for (std::string& text : validity_warnings(one, element == 0 ? first_chain : Chain(one))) {
            const auto same = std::ranges::find_if(all, [words = without_numbers(text)](const Told& told) {
                return without_numbers(told.text) == words;
            });
            if (same == all.end()) {
                all.push_back({std::move(text), element, element});
            } else {
                same->others += same->last == element ? 0 : 1;
                same->last = element;
                same->is_same = same->is_same && same->text == text;
            }
        }
    }
    Warnings warnings;
    for (const Told& told : all) {
        if (told.is_same && told.others + 1 == chains_of(scene)) {
            warnings.push_back(told.text);
            continue;
        }
        const std::string others = told.others == 1 ? "another" : fmt::format("{} others", told.others);
        warnings.push_back(
            fmt::format("element {}: {}{}", told.element + 1, told.text,
                        told.others == 0
                            ? ""
                            : fmt::format(" (and {}{})", others, told.is_same ? "" : " with other numbers")));
    }
    return warnings;
}

Warnings scene_warnings(const Resolution& resolved, const Chain& chain) {
    Warnings warnings;
    if (auto missed = missed_accuracy(resolved)) {
        warnings.push_back(*std::move(missed));
    }
    append(warnings, unused_key_warnings(resolved.scene));
    if (!is_array(resolved.scene)) {
        append(warnings, validity_warnings(resolved.scene, chain));
        return warnings;
    }
    append(warnings, warnings_of_elements(resolved.scene, chain));
    append(warnings, array_warnings(resolved.scene));
    return warnings;
}

Warnings all_warnings(const Run& run) {
    Warnings warnings = scene_warnings(run.resolved);
    append(warnings, run.warnings);
    return warnings;
}

namespace {

/// Why the accuracy is missed, behind "; "; empty where there is no particular reason.
std::string reason_of_miss(const Resolution& resolved) {
    const StepAdvice& advice = resolved.advice;
    const auto& estimate = resolved.estimate;
    if (constexpr double far_too_many = 1e8; resolved.steps_per_burst > far_too_many) {
        return fmt::format("; the scene is too stiff: with its steps of {:.2g} s a burst takes {:.2g}",
                           *resolved.scene.numerics.step_s, resolved.steps_per_burst);
    }
    if (estimate && estimate->of_fit > 0.5 * estimate->error) {
        return "; no step changes that: fits of the plate's response by other numbers of poles differ by as "
               "much, because the contact's force has parts beyond the band that is fitted (fit_band_hz of "
               "check)";
    }
    if (estimate && estimate->amplifies) {
        return "; the motion amplifies rounding errors, so that no step is good enough: judge it by "
               "energy_residual and statistics, not sample by sample";
    }
    if (resolved.scene.numerics.rest_tolerance > 0) {
        return "; part of it is the quieter ringing that numerics.rest_tolerance cuts off";
    }
    if (!advice.accuracy_met) {
        return "";
    }
    return resolved.step_set_by_scene
               ? fmt::format("; without numerics.step_s the program chooses a step for an accuracy of {:g}",
                             advice.accuracy)
               : fmt::format(
                     "; it is kept over the first {:.3g} s, but errors grow: a smaller "
                     "numerics.accuracy may do",
                     advice.pilot_duration_s);
}

}  // namespace

std::string missed_by(const Resolution& resolved, const ErrorEstimate& estimate) {
    return fmt::format("the estimated error over the first {:.3g} s is {:.2g}", estimate.over_s,
                       estimate.error) +
           (resolved.step_set_by_scene
                ? std::string(", by the step that the scene gives")
                : fmt::format(", above the requested accuracy of {:g}", resolved.advice.accuracy));
}

std::optional<std::string> missed_accuracy(const Resolution& resolved) {
    if (resolved.may_miss_accuracy()) {
        return fmt::format(
            "the error is estimated over the first {:.3g} s of {:.3g} s; how far it grows after that is not "
            "known",
            resolved.estimate->over_s, *resolved.run_s);
    }
    if (!resolved.misses_accuracy()) {
        return std::nullopt;
    }
    return (resolved.estimate ? missed_by(resolved, *resolved.estimate)
                              : fmt::format("the error could not be estimated; requested: {:g}",
                                            resolved.advice.accuracy)) +
           reason_of_miss(resolved);
}

}  // namespace hertzline::measures
