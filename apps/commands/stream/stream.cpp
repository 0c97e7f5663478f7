// hertzline stream: simulates a scene in step with the clock and publishes it.

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/preflight.hpp"
#include "apps/commands/publish_session.hpp"
#include "apps/commands/stream/live_control.hpp"
#include "apps/commands/stream/scope_child.hpp"
#include "apps/commands/stream/stream_session.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "measures/resources.hpp"
#include "measures/run.hpp"
#include "measures/scene_report.hpp"
#include "recordings/columns.hpp"
#include "recordings/recording_formats.hpp"
#include "stream/inputs/simulation_source.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "Streams: v_out, v_last, v_plate, v_chain, v_horn, f_last, f_chain, each as NAME/np and NAME/raw; "
    "of a modal plate v_centre, v_face and p_axis instead of v_plate.\n"
    "Topics beside them: meta, meters, end.\n"
    "Ctrl-C ends the stream with recordings saved and a summary.\n"
    "Examples:\n"
    "  hertzline stream paper-stream\n"
    "  hertzline stream paper-stream --pace 0.1 --bind ipc:///tmp/hertzline\n"
    "  hertzline stream paper-stream --record out.h5 --columns v_out,v_horn\n"
    "  hertzline stream paper-stream --control tcp://127.0.0.1:5574 --scope\n"
    "  hertzline stream paper-wall --pace flat-out --duration 2e-3 --record wall.csv";

struct StreamOptions {
    SceneRequest scene;
    PublishRequest publish;
    ControlRequest control;
    ScopeChildRequest scope;
    std::vector<std::string> recordings;
    std::vector<std::string> columns;  ///< taps to be recorded; none: the usual ones
    std::optional<double> wav_scale;
};

/// Returns the recorded taps of the streamed ones. @param scene null: it has faults
TapSet taps_to_record(const StreamOptions& arguments, const Scene* scene, Faults& faults) {
    if (arguments.recordings.empty()) {
        return {};
    }
    if (arguments.columns.empty()) {
        return scene == nullptr ? TapSet() : recorded_taps(*scene);
    }
    return measures::taps_named("--columns", arguments.columns,
                                scene == nullptr ? streamed_taps : streamed_taps_of(*scene), faults);
}

void refuse_shortages(const StreamOptions& arguments, const Scene& scene,
                      const stream::StreamOptions& options, const stream::PublisherOptions& publishing,
                      TapSet recorded) {
    const double memory = stream::SimulationSource::memory_bytes(scene) +
                          stream_bytes(stream::SimulationSource::format_of(scene), options.pace, publishing) +
                          memory_of_recordings(scene, recorded, arguments.recordings.size());
    if (const auto shortage = measures::memory_shortage("streaming this scene", memory)) {
        throw std::runtime_error(*shortage);
    }
    if (options.samples) {
        refuse_disk_shortages(scene, static_cast<double>(*options.samples), arguments.recordings, recorded);
    }
}

/// The request of the arguments.
struct CheckedArguments {
    std::optional<stream::CurveServer> curve;
    std::optional<stream::CurveServer> control_curve;
    Resolution resolved;
    TapSet recorded;
};

/// @throws WrongUse with every fault
CheckedArguments checked(const StreamOptions& arguments) {
    Faults faults;
    CheckedArguments result;
    check_recordings(arguments.recordings, faults);
    result.curve = checked_curve(arguments.publish, faults);
    check_scope(arguments.scope, arguments.publish.curve, faults);
    result.control_curve = checked_control(arguments.control, arguments.publish.curve, faults);
    if (arguments.recordings.empty() && !arguments.columns.empty()) {
        faults.add("--columns needs --record FILE to save to");
    }
    check_wav_scale(arguments.wav_scale, arguments.recordings, faults);
    auto resolved = faults.value_of({}, resolved_scene(arguments.scene, Lasting::endless));
    if (resolved) {
        if (const auto fault = stream::SimulationSource::fault_of(resolved->scene)) {
            faults.add(fault->message());
        }
    }
    result.recorded = taps_to_record(arguments, resolved ? &resolved->scene : nullptr, faults);
    faults.refuse<WrongUse>();
    result.resolved = *std::move(resolved);
    return result;
}

/// Warns of contacts, and of a scene that is far too slow for a stream.
void warn_of_scene(const StreamOptions& arguments, const Resolution& resolved) {
    const Scene& scene = resolved.scene;
    if (const double factor = stream::expected_real_time_factor(resolved);
        factor < stream::least_real_time_factor) {
        spdlog::warn("{}: {} is to be expected", printable(arguments.scene.scene),
                     stream::real_time_factor_text(factor));
    }
    for (const std::string& text :
         measures::contact_warnings(scene, measures::peak_overlaps(scene, measures::first_burst_s(scene)))) {
        spdlog::warn("{}: {}", printable(arguments.scene.scene), text);
    }
}

std::unique_ptr<LiveControl> control_of(const StreamOptions& arguments, const CheckedArguments& checked,
                                        stream::SimulationSource& source,
                                        std::optional<std::int64_t> samples) {
    if (arguments.control.endpoint.empty()) {
        return nullptr;
    }
    auto control = std::make_unique<LiveControl>(arguments.control, checked.control_curve,
                                                 parsed_scene(arguments.scene).value().scene,
                                                 checked.resolved, source, samples);
    spdlog::info("control {}", control->endpoint());
    return control;
}

Exit stream(const StreamOptions& arguments) {
    const CheckedArguments asked = checked(arguments);
    const Scene& scene = asked.resolved.scene;
    warn_of_scene(arguments, asked.resolved);
    const double rate = scene.output.sample_rate_hz;
    stream::StreamOptions options =
        stream_options(arguments.publish, rate,
                       arguments.recordings.empty() ? stream::OnOverrun::drop : stream::OnOverrun::wait);
    options.about = provenance_of_stream(asked.resolved, options.run);
    const stream::PublisherOptions publishing =
        publisher_options(arguments.publish, stream::SimulationSource::format_of(scene), asked.curve);
    refuse_shortages(arguments, scene, options, publishing, asked.recorded);
    stop_asked();  // from here on there are files to be cleaned up
    stream::SimulationSource source(scene, asked.recorded);
    const std::unique_ptr<LiveControl> control = control_of(arguments, asked, source, options.samples);
    if (control) {
        control->add_to(options.about);
    }
    stream::Publisher publisher(arguments.publish.endpoint, stream::all_topics, publishing);
    ProgressLine line;
    recordings::RecordingSet recordings(
        arguments.recordings,
        {.columns = recordings::recorded_columns(asked.recorded, channel_counts(scene)),
         .sample_rate_hz = rate,
         .provenance = options.about,
         .full_scale = arguments.wav_scale.value_or(1)},
        options.pace.is_flat_out() ? recordings::RecordingPatience::of_a_second(stop_asked())
                                   : recordings::RecordingPatience::none(stop_asked()),
        [&line](const std::string& text) {
            line.clear();
            spdlog::error("{}; the stream continues", text);
        });
    recordings::RowBuilder row_builder(recordings, asked.recorded);
    stream::Pipeline pipeline(options, source, publisher, recordings.any_left() ? &row_builder : nullptr);
    const std::unique_ptr<ScopeChild> scope =
        scope_beside(arguments.scope, local_endpoint(publisher.endpoint()),
                     control ? local_endpoint(control->endpoint()) : std::string());
    StreamSession session(arguments.scene.scene, asked.resolved, options.about, recordings, line,
                          control.get());
    try {
        publish_to_the_end(pipeline, publisher, line, arguments.publish.format, session.callbacks());
    } catch (...) {
        recordings.commit();  // the samples up to here are complete
        throw;
    }
    return recordings.complete() ? Exit::done : Exit::failed;
}

}  // namespace

Run stream_command(CLI::App& app) {
    auto arguments = std::make_shared<StreamOptions>();
    add_scene_options(app, arguments->scene)->required();
    add_repeatable_option(app, "--record", arguments->recordings,
                          "save the samples as well; the ending picks the format: " +
                              recordings::recording_endings() + "; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    add_columns_option(app, arguments->columns, streamed_taps);
    add_wav_scale_option(app, arguments->wav_scale);
    add_publish_options(app, arguments->publish);
    add_control_options(app, arguments->control);
    add_scope_child_options(app, arguments->scope);
    app.footer(examples);
    return [arguments] { return stream(*arguments); };
}

}  // namespace hertzline::app
