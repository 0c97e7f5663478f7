#include "stream/measures/run_summary.hpp"

#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/model/strength.hpp"
#include "core/model/validity.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"
#include "stream/measures/record_warnings.hpp"
#include "stream/measures/spectrum_json.hpp"
#include "stream/provenance.hpp"

namespace hertzline::stream {

namespace {

using Json = nlohmann::ordered_json;

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

std::vector<SummaryGroup> measures_of_run(const RunRecord& record, const Scene& scene,
                                          SpectrumAnalyser& analyser, std::optional<double> band_from_hz,
                                          Warnings& warnings) {
    const std::vector<double>& v_out = record.taps.front().values;
    const auto spectrum = analyser.analyse(v_out, scene.drive.frequency_hz, band_from_hz);
    const std::vector<double> switching = switching_db(analyser, spectrum, record);
    append(warnings, record_warnings(scene, v_out));
    append(warnings, switching_warnings(switching));
    std::vector<SummaryGroup> groups{
        {"result", {{"peak_v_out_m_per_s", peak_of(v_out)}, {"peak_v_last_m_per_s", record.peak_v_last}}, ""},
        {"spectrum of v_out", spectrum_json(spectrum), ""}};
    groups.back().values["switching_db"] = switching.empty() ? Json(nullptr) : Json(switching);
    for (const TapRecord& tap : std::span(record.taps).subspan(1)) {
        const TapRow& row = row_of(tap.tap);
        Json values{{fmt::format("peak_{}", row.column), peak_of(tap.values)}};
        values.update(spectrum_json(analyser.analyse(tap.values, scene.drive.frequency_hz, band_from_hz)));
        groups.push_back({std::string(row.name), std::move(values), std::string(row.name)});
    }
    return groups;
}

SummaryGroup contacts_of_run(Simulation& simulation, Warnings& warnings) {
    const ContactLoad load = contact_load(simulation.chain(), simulation.state().peak_overlap,
                                          simulation.scene().chain.diameter_m / 2);
    const Scene& scene = simulation.scene();
    append(warnings, validity_warnings(load));
    if (auto beyond = strength_warning(scene, simulation.chain(), load)) {
        warnings.push_back(*std::move(beyond));
    }
    const ContactLoad rest =
        contact_load(simulation.chain(), simulation.chain().static_overlap, scene.chain.diameter_m / 2);
    const std::optional<double> ratio = strength_ratio(pressure_limits(scene), load);
    Json values;
    values["peak_contact_force_n"] = load.force_n;
    values["peak_contact_pressure_pa"] = load.pressure_pa;
    values["static_contact_pressure_pa"] = rest.pressure_pa;
    values["peak_strength_ratio"] = ratio ? Json(*ratio) : Json(nullptr);
    values["peak_overlap_ratio"] = load.overlap_ratio;
    values["contact_events"] = simulation.contact_events();
    if (const DampingLaw law = simulation.chain().damping_law; law != DampingLaw::dashpot) {
        values["damping_law"] = word(law);
    }
    return {"contacts", std::move(values), ""};
}

SummaryGroup trust_of_run(Simulation& simulation, const ResolvedScene& resolved) {
    Json values;
    add_estimate(values, resolved.estimate);
    values["energy_residual"] = simulation.energy_residual();
    if (simulation.chain().end.plate) {
        const Ledger ledger = simulation.ledger();
        values["plate_passed_j"] = ledger.passed;
        values["plate_lost_j"] = ledger.plate_lost;
        values["plate_held_j"] = ledger.plate_held;
        values["radiated_j"] = ledger.radiated();
    }
    return {"trust", std::move(values), ""};
}

SummaryGroup account_of_run(const Simulation& simulation, std::size_t rows) {
    const Scene& scene = simulation.scene();
    Json values;
    values["simulated_s"] = static_cast<double>(rows - 1) / scene.output.sample_rate_hz;
    values["rows"] = rows;
    values["integrator"] = word(*scene.numerics.integrator);
    values["step_s"] = simulation.step_s();
    values["steps"] = simulation.steps();
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

std::optional<std::string> missed_accuracy(const ResolvedScene& resolved) {
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

}  // namespace hertzline::stream
