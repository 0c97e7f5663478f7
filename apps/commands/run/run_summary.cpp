#include "apps/commands/run/run_summary.hpp"

#include <span>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/model/validity.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"
#include "stream/measures/record_warnings.hpp"
#include "stream/measures/spectrum.hpp"
#include "stream/measures/spectrum_json.hpp"
#include "stream/provenance.hpp"

namespace hertzline::app {

namespace {

/// How much larger the harmonics of v_out are for the jumps of its formula [dB]; empty without a plate.
std::vector<double> switching_db(stream::SpectrumAnalyser& analyser, const stream::SpectrumSummary& v_out,
                                 const RunRecord& record) {
    if (record.v_out_smooth.empty()) {
        return {};
    }
    const auto smooth = analyser.analyse(record.v_out_smooth, v_out.fundamental_hz);
    return stream::level_differences_db(v_out.harmonics, smooth.harmonics);
}

}  // namespace

std::vector<SummaryGroup> measure(const RunRecord& record, const Scene& scene,
                                  std::optional<double> band_from_hz) {
    stream::SpectrumAnalyser analyser(record.rows(), scene.output.sample_rate_hz);
    const std::vector<double>& v_out = record.taps.front().values;
    const auto spectrum = analyser.analyse(v_out, scene.drive.frequency_hz, band_from_hz);
    const std::vector<double> switching = switching_db(analyser, spectrum, record);
    for (const auto& warnings :
         {stream::record_warnings(scene, v_out), stream::switching_warnings(switching)}) {
        for (const std::string& text : warnings) {
            spdlog::warn(text);
        }
    }
    std::vector<SummaryGroup> groups{
        {"result",
         {{"peak_v_out_m_per_s", stream::peak_of(v_out)}, {"peak_v_last_m_per_s", record.peak_v_last}},
         ""},
        {"spectrum of v_out", stream::spectrum_json(spectrum), ""}};
    groups.back().values["switching_db"] = switching.empty() ? Json(nullptr) : Json(switching);
    for (const TapRecord& tap : std::span(record.taps).subspan(1)) {
        const TapRow& row = row_of(tap.tap);
        Json values{{fmt::format("peak_{}", row.column), stream::peak_of(tap.values)}};
        values.update(
            stream::spectrum_json(analyser.analyse(tap.values, scene.drive.frequency_hz, band_from_hz)));
        groups.push_back({std::string(row.name), std::move(values), std::string(row.name)});
    }
    return groups;
}

SummaryGroup contacts(Simulation& simulation) {
    const ContactLoad load = contact_load(simulation.chain(), simulation.state().peak_overlap,
                                          simulation.scene().chain.diameter_m / 2);
    for (const std::string& text : validity_warnings(load)) {
        spdlog::warn(text);
    }
    Json values;
    values["peak_contact_force_n"] = load.force_n;
    values["peak_contact_pressure_pa"] = load.pressure_pa;
    values["peak_overlap_ratio"] = load.overlap_ratio;
    values["contact_events"] = simulation.contact_events();
    if (const DampingLaw law = simulation.chain().damping_law; law != DampingLaw::dashpot) {
        values["damping_law"] = word(law);
    }
    return {"contacts", std::move(values), ""};
}

SummaryGroup trust(Simulation& simulation, const ResolvedScene& resolved) {
    Json values;
    stream::add_estimate(values, resolved.estimate);
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

SummaryGroup account(const Simulation& simulation, double setup_s, const RunRecord& record,
                     const stream::RecordingSet& recordings) {
    const Scene& scene = simulation.scene();
    const double simulated_s = static_cast<double>(record.rows() - 1) / scene.output.sample_rate_hz;
    const double wall_s = record.wall_s();
    Json values;
    values["simulated_s"] = simulated_s;
    values["rows"] = record.rows();
    values["integrator"] = word(*scene.numerics.integrator);
    values["step_s"] = simulation.step_s();
    values["steps"] = simulation.steps();
    values["setup_s"] = setup_s;
    values["wall_s"] = wall_s;
    values["real_time_factor"] = wall_s > 0 ? Json(simulated_s / wall_s) : Json(nullptr);
    values["recordings"] = stream::recordings_json(recordings);
    values["scene_hash"] = scene_hash(scene);
    values["version"] = stream::program_version();
    return {"run", std::move(values), ""};
}

}  // namespace hertzline::app
