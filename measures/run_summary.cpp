#include "measures/run_summary.hpp"

#include <optional>
#include <span>
#include <utility>

#include "measures/provenance.hpp"
#include "measures/record_warnings.hpp"
#include "measures/spectrum_json.hpp"
#include <fmt/format.h>

#include "core/model/validity.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"

namespace hertzline::measures {

namespace {

/// How much larger the harmonics of v_out are for the jumps of its formula [dB]; empty without a plate.
std::vector<double> switching_db(SpectrumAnalyser& analyser, const SpectrumSummary& v_out,
                                 const RunRecord& record) {
    if (record.v_out_smooth.empty()) {
        return {};
    }
    return level_differences_db(v_out.harmonics,
                                analyser.harmonics(record.v_out_smooth, v_out.fundamental_hz));
}

void append(Warnings& warnings, const Warnings& more) {
    warnings.insert(warnings.end(), more.begin(), more.end());
}

}  // namespace

Warnings scene_warnings(const Resolution& resolved) {
    Warnings warnings = validity_warnings(resolved.scene, Chain(resolved.scene));
    if (auto missed = missed_accuracy(resolved)) {
        warnings.push_back(*std::move(missed));
    }
    return warnings;
}

std::vector<SummaryGroup> measures_of_run(const RunRecord& record, const Scene& scene,
                                          SpectrumAnalyser& analyser, std::optional<double> band_from_hz,
                                          Warnings& warnings) {
    const std::vector<double>& v_out = record.taps.front().values;
    const auto spectrum = analyser.analyse(v_out, scene.drive.frequency_hz, band_from_hz);
    const std::vector<double> switching = switching_db(analyser, spectrum, record);
    append(warnings, record_warnings(scene, v_out));
    append(warnings, band_warnings("v_out", spectrum));
    append(warnings, switching_warnings(switching));
    const std::optional<double> ringing = ringing_ratio(scene, v_out);
    std::vector<SummaryGroup> groups{{"result",
                                      {{"peak_v_out_m_per_s", peak_of(v_out)},
                                       {"peak_v_last_m_per_s", record.peak_v_last},
                                       {"burst_shown_ratio", burst_shown_ratio(scene)},
                                       {"ringing_ratio", ringing ? Json(*ringing) : Json(nullptr)}},
                                      ""},
                                     {"spectrum of v_out", spectrum_json(spectrum), ""}};
    groups.back().values["switching_db"] = switching.empty() ? Json(nullptr) : Json(switching);
    for (const TapRecord& tap : std::span(record.taps).subspan(1)) {
        const TapRow& row = row_of(tap.tap);
        Json values{{fmt::format("peak_{}", row.column), peak_of(tap.values)}};
        const auto of_tap = analyser.analyse(tap.values, scene.drive.frequency_hz, band_from_hz);
        append(warnings, band_warnings(row.name, of_tap));
        values.update(spectrum_json(of_tap));
        groups.push_back({std::string(row.name), std::move(values), std::string(row.name)});
    }
    return groups;
}

SummaryGroup contacts_of_run(const RunRecord& record, const Scene& scene, Warnings& warnings) {
    const RunAccount& account = record.account;
    append(warnings, validity_warnings(account.load));
    if (account.strength_warning) {
        warnings.push_back(*account.strength_warning);
    }
    Json values;
    values["peak_contact_force_n"] = account.load.force_n;
    values["peak_contact_pressure_pa"] = account.load.pressure_pa;
    values["static_contact_pressure_pa"] = account.static_pressure_pa;
    values["peak_strength_ratio"] = account.strength_ratio ? Json(*account.strength_ratio) : Json(nullptr);
    values["peak_overlap_ratio"] = account.load.overlap_ratio;
    values["contact_events"] = account.contact_events;
    if (const DampingLaw law = scene.chain.damping_law; law != DampingLaw::dashpot) {
        values["damping_law"] = word(law);
    }
    return {"contacts", std::move(values), ""};
}

SummaryGroup trust_of_run(const RunRecord& record, const Resolution& resolved) {
    Json values;
    add_estimate(values, resolved.estimate);
    values["energy_residual"] = record.account.energy_residual;
    if (const std::optional<PlateEnergy>& plate = record.account.plate) {
        values["plate_passed_j"] = plate->passed;
        values["plate_lost_j"] = plate->lost;
        values["plate_held_j"] = plate->held;
        values["radiated_j"] = plate->radiated;
    }
    return {"trust", std::move(values), ""};
}

SummaryGroup account_of_run(const RunRecord& record, const Scene& scene) {
    Json values;
    values["simulated_s"] = static_cast<double>(record.rows() - 1) / scene.output.sample_rate_hz;
    values["rows"] = record.rows();
    values["integrator"] = word(*scene.numerics.integrator);
    values["step_s"] = record.account.step_s;
    if (scene.numerics.poles) {
        values["poles"] = *scene.numerics.poles;
    }
    values["steps"] = record.account.steps;
    return {"run", std::move(values), ""};
}

void add_times(SummaryGroup& account, double setup_s, double wall_s) {
    Json& values = account.values;
    values["setup_s"] = setup_s;
    values["wall_s"] = wall_s;
    values["real_time_factor"] =
        wall_s > 0 ? Json(values["simulated_s"].get<double>() / wall_s) : Json(nullptr);
}

void add_identity(SummaryGroup& account, const Scene& scene) {
    account.values["scene_hash"] = scene_hash(scene);
    account.values["version"] = program_version();
}

Json summary_json(std::span<const SummaryGroup> groups) {
    Json summary;
    for (const SummaryGroup& group : groups) {
        Json& place = group.member.empty() ? summary : summary[group.member];
        place.update(group.values);
    }
    return summary;
}

std::optional<std::string> missed_accuracy(const Resolution& resolved) {
    const StepAdvice& advice = resolved.advice;
    if (resolved.may_miss_accuracy()) {
        return fmt::format(
            "the error is estimated over the first {:.3g} s of {:.3g} s; what it grows to is not known",
            resolved.estimate->over_s, *resolved.run_s);
    }
    if (!resolved.misses_accuracy()) {
        return std::nullopt;
    }
    if (!resolved.estimate) {
        return fmt::format("the error could not be estimated; requested: {:g}", advice.accuracy);
    }
    const ErrorEstimate& estimate = *resolved.estimate;
    std::string why;
    if (estimate.amplifies) {
        why =
            "; the motion amplifies rounding errors, so that no step is good enough: judge it by "
            "energy_residual and statistics, "
            "not sample by sample";
    } else if (advice.accuracy_met) {
        why = fmt::format(
            "; it is kept over the first {:.3g} s, but errors grow: a smaller numerics.accuracy may do",
            advice.pilot_duration_s);
    }
    return fmt::format(
        "the estimated error over the first {:.3g} s is {:.2g}, above the requested accuracy of {:g}{}",
        estimate.over_s, estimate.error, advice.accuracy, why);
}

}  // namespace hertzline::measures
