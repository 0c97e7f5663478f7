// hertzline stream: a scene to whoever subscribes, in step with the clock.

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/preflight.hpp"
#include "apps/commands/publish_session.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/recording_formats.hpp"
#include "stream/recordings/row_builder.hpp"
#include "stream/resources.hpp"
#include "stream/sources/simulation_source.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "Streams: v_out, v_last, v_plate, v_chain, each as NAME/np and NAME/raw; topics meta, meters, end.\n"
    "Ctrl-C ends the stream with recordings saved and a summary.\n"
    "Examples:\n"
    "  hertzline stream paper-stream\n"
    "  hertzline stream paper-stream --pace 0.1 --bind ipc:///tmp/hertzline\n"
    "  hertzline stream paper-wall --pace flat-out --duration 2e-3 --wait-for-subscriber --record wall.csv";

struct StreamArguments {
    SceneRequest scene;
    StreamingRequest streaming;
    std::vector<std::string> recordings;
};

void refuse_shortages(const StreamArguments& options, const Scene& scene, const stream::StreamOptions& plan) {
    const double memory = stream::SimulationSource::memory_bytes(scene) +
                          stream::ring_bytes(stream::SimulationSource::format_of(scene), plan.pace);
    if (const auto shortage = stream::memory_shortage("streaming this scene", memory)) {
        throw std::runtime_error(*shortage);
    }
    if (plan.samples) {
        refuse_disk_shortages(scene, static_cast<double>(*plan.samples), options.recordings,
                              stream::RecordedBodies::outputs);
    }
}

/// Of the samples: what meta and recordings say.
Json about(const ResolvedScene& resolved, const std::string& run) {
    return stream::provenance_json(
        {resolved.scene, resolved.estimated_error, stream::utc_text(std::chrono::system_clock::now()), run});
}

Exit stream(const StreamArguments& options) {
    refuse_wrong_files(options.recordings);
    const std::optional<stream::CurveServer> curve = checked(options.streaming);
    const ResolvedScene resolved = resolved_scene(options.scene);
    const Scene& scene = resolved.scene;
    const double rate = scene.output.sample_rate_hz;
    stream::StreamOptions plan =
        plan_of(options.streaming, rate,
                options.recordings.empty() ? stream::OnOverrun::drop : stream::OnOverrun::wait);
    plan.about = about(resolved, plan.run);
    refuse_shortages(options, scene, plan);
    stop_asked();  // from here on there are files to be cleaned up
    stream::SimulationSource source(scene, !options.recordings.empty());
    stream::Publisher publisher(options.streaming.endpoint, all_topics,
                                publisher_options(source.format(), curve));
    ProgressLine line;
    stream::RecordingSet recordings(
        options.recordings,
        {.columns = stream::recorded_columns(scene, stream::RecordedBodies::outputs),
         .sample_rate_hz = rate,
         .provenance = plan.about},
        [&line](const std::string& text) {
            line.clear();
            spdlog::error("{}; the stream goes on", text);
        });
    stream::RowBuilder recorder(recordings, stream::RecordedBodies::outputs);
    stream::Pipeline pipeline(plan, source, publisher, recordings.any_left() ? &recorder : nullptr);
    stream_to_the_end(pipeline, publisher, line, options.streaming.format,
                      [&](Json& summary, const stream::StreamMeters& meters) {
                          // Before subscribers hear of the end recordings are complete, or known not to be.
                          recordings.commit();
                          summary["recordings"] = recordings_json(recordings);
                          summary["steps"] = meters.account.steps;
                          summary["step_s"] = *scene.numerics.step_s;
                          summary["integrator"] = word(*scene.numerics.integrator);
                          summary["estimated_error"] = number_or_null(resolved.estimated_error);
                          summary["scene_hash"] = scene_hash(scene);
                          summary["version"] = stream::program_version();
                      });
    return recordings.sound() ? Exit::done : Exit::failed;
}

}  // namespace

Command stream_command(CLI::App& program) {
    auto options = std::make_shared<StreamArguments>();
    CLI::App* command =
        program.add_subcommand("stream", "simulate a scene in step with the clock and publish it");
    add_scene_options(*command, options->scene)->required();
    add_repeatable_option(*command, "--record", options->recordings,
                          "save the samples as well; the ending picks the format: " +
                              stream::recording_endings() + "; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    add_streaming_options(*command, options->streaming);
    command->footer(examples);
    return {command, [options] { return stream(*options); }};
}

}  // namespace hertzline::app
