#include "apps/commands/run/run_summary.hpp"

#include <string>

#include "measures/spectrum.hpp"
#include <spdlog/spdlog.h>

namespace hertzline::app {

namespace {

void warn(const measures::Warnings& of_part, measures::Warnings& all) {
    for (const std::string& text : of_part) {
        spdlog::warn(text);
        all.push_back(text);
    }
}

}  // namespace

std::vector<SummaryGroup> measure(const measures::RunRecord& record, const Scene& scene,
                                  std::optional<double> band_from_hz, measures::Warnings& warnings) {
    measures::SpectrumAnalyser analyser(record.rows(), scene.output.sample_rate_hz);
    measures::Warnings of_record;
    std::vector<SummaryGroup> groups =
        measures::measures_of_run(record, scene, analyser, band_from_hz, of_record);
    warn(of_record, warnings);
    return groups;
}

SummaryGroup contacts(const measures::RunRecord& record, const Scene& scene, measures::Warnings& warnings) {
    measures::Warnings of_contacts;
    SummaryGroup group = measures::contacts_of_run(record, scene, of_contacts);
    warn(of_contacts, warnings);
    return group;
}

SummaryGroup warnings_group(const measures::Warnings& warnings) {
    return {"", {{"warnings", warnings}}, ""};
}

SummaryGroup account(const measures::RunRecord& record, const Scene& scene, double setup_s,
                     const recordings::RecordingSet& recordings) {
    SummaryGroup group = measures::account_of_run(record, scene);
    measures::add_times(group, setup_s, record.wall_s());
    group.values["recordings"] = recordings::recordings_json(recordings);
    measures::add_identity(group, scene);
    return group;
}

}  // namespace hertzline::app
