#include "apps/commands/run/run_summary.hpp"

#include <string>

#include <spdlog/spdlog.h>

#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"
#include "stream/measures/spectrum.hpp"
#include "stream/provenance.hpp"

namespace hertzline::app {

namespace {

void warn(const stream::Warnings& warnings) {
    for (const std::string& text : warnings) {
        spdlog::warn(text);
    }
}

}  // namespace

std::vector<SummaryGroup> measure(const stream::RunRecord& record, const Scene& scene,
                                  std::optional<double> band_from_hz) {
    stream::SpectrumAnalyser analyser(record.rows(), scene.output.sample_rate_hz);
    stream::Warnings warnings;
    std::vector<SummaryGroup> groups =
        stream::measures_of_run(record, scene, analyser, band_from_hz, warnings);
    warn(warnings);
    return groups;
}

SummaryGroup contacts(Simulation& simulation) {
    stream::Warnings warnings;
    SummaryGroup group = stream::contacts_of_run(simulation, warnings);
    warn(warnings);
    if (const DampingLaw law = simulation.chain().damping_law; law != DampingLaw::dashpot) {
        group.values["damping_law"] = word(law);
    }
    return group;
}

SummaryGroup account(const Simulation& simulation, double setup_s, const stream::RunRecord& record,
                     const stream::RecordingSet& recordings) {
    SummaryGroup group = stream::account_of_run(simulation, record.rows());
    const double wall_s = record.wall_s();
    Json& values = group.values;
    values["setup_s"] = setup_s;
    values["wall_s"] = wall_s;
    values["real_time_factor"] =
        wall_s > 0 ? Json(values["simulated_s"].get<double>() / wall_s) : Json(nullptr);
    values["recordings"] = stream::recordings_json(recordings);
    values["scene_hash"] = scene_hash(simulation.scene());
    values["version"] = stream::program_version();
    return group;
}

}  // namespace hertzline::app
