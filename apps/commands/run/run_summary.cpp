#include "apps/commands/run/run_summary.hpp"

#include <string>

#include <spdlog/spdlog.h>

#include "stream/measures/spectrum.hpp"

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

SummaryGroup contacts(const stream::RunRecord& record, const Scene& scene) {
    stream::Warnings warnings;
    SummaryGroup group = stream::contacts_of_run(record, scene, warnings);
    warn(warnings);
    return group;
}

SummaryGroup account(const stream::RunRecord& record, const Scene& scene, double setup_s,
                     const stream::RecordingSet& recordings) {
    SummaryGroup group = stream::account_of_run(record, scene);
    stream::add_times(group, setup_s, record.wall_s());
    group.values["recordings"] = stream::recordings_json(recordings);
    stream::add_identity(group, scene);
    return group;
}

}  // namespace hertzline::app
