#include "apps/commands/run/run_summary.hpp"

#include <string>

#include <spdlog/spdlog.h>

#include "stream/measures/spectrum.hpp"

namespace hertzline::app {

namespace {

void warn(const stream::Warnings& of_part, stream::Warnings& all) {
    for (const std::string& text : of_part) {
        spdlog::warn(text);
        all.push_back(text);
    }
}

}  // namespace

std::vector<SummaryGroup> measure(const stream::RunRecord& record, const Scene& scene,
                                  std::optional<double> band_from_hz, stream::Warnings& warnings) {
    stream::SpectrumAnalyser analyser(record.rows(), scene.output.sample_rate_hz);
    stream::Warnings of_record;
    std::vector<SummaryGroup> groups =
        stream::measures_of_run(record, scene, analyser, band_from_hz, of_record);
    warn(of_record, warnings);
    return groups;
}

SummaryGroup contacts(const stream::RunRecord& record, const Scene& scene, stream::Warnings& warnings) {
    stream::Warnings of_contacts;
    SummaryGroup group = stream::contacts_of_run(record, scene, of_contacts);
    warn(of_contacts, warnings);
    return group;
}

SummaryGroup warnings_group(const stream::Warnings& warnings) {
    return {"", {{"warnings", warnings}}, ""};
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
