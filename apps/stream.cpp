// hertzline stream: a scene to whoever subscribes, in step with the clock.

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "apps/commands.hpp"
#include "apps/curve_arguments.hpp"
#include "apps/output.hpp"
#include "apps/progress.hpp"
#include "apps/run_needs.hpp"
#include "apps/scene_argument.hpp"
#include "apps/signals.hpp"
#include "core/scene_toml.hpp"
#include "core/scene_words.hpp"
#include "stream/endpoint.hpp"
#include "stream/pipeline.hpp"
#include "stream/resources.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "Streams: v_out, v_last, v_plate, v_chain, each as NAME/np and NAME/raw; topics meta, meters, end.\n"
    "Ctrl-C ends the stream with recordings saved and a summary.\n"
    "Examples:\n"
    "  hertzline stream paper-stream\n"
    "  hertzline stream paper-stream --pace 0.1 --bind ipc:///tmp/hertzline\n"
    "  hertzline stream paper-wall --pace flat-out --duration 2e-3 --wait-for-subscriber --record wall.csv";

/// What may be reached from other machines.
enum class Exposure { encrypted, anything };

struct StreamOptions {
    SceneRequest scene;
    std::string endpoint = "tcp://127.0.0.1:5573";
    CurveServerRequest curve;
    Exposure exposure = Exposure::encrypted;
    std::string pace = "realtime";
    std::optional<double> duration_s;
    std::string recording;  // empty: none
    StreamStart start = StreamStart::at_once;
    Format format = Format::text;
};

Pace pace_of(const StreamOptions& options) {
    const Expected<Pace> pace = parse_pace(options.pace);
    if (!pace) {
        throw WrongUse("--pace: " + pace.error());
    }
    return *pace;
}

std::optional<std::int64_t> samples_of(const StreamOptions& options, const Scene& scene) {
    if (!options.duration_s) {
        return std::nullopt;
    }
    constexpr double most_samples = 9e18;  // what 63 bits hold
    const double samples = std::round(*options.duration_s * scene.output.sample_rate_hz);
    if (samples > most_samples) {
        throw WrongUse(
            fmt::format("--duration: found {} s, which is {:.3g} samples, allowed: at most {:.0e} samples",
                        *options.duration_s, samples, most_samples));
    }
    return static_cast<std::int64_t>(std::max(1.0, samples));
}

void refuse_wrong_use(const StreamOptions& options) {
    if (const auto fault = endpoint_fault(options.endpoint, EndpointUse::bind)) {
        throw WrongUse("--bind: " + *fault);
    }
    if (!is_local(options.endpoint) && options.curve.key.empty() && options.exposure == Exposure::encrypted) {
        throw WrongUse(fmt::format(
            "--bind: {} can be reached from other machines, and anybody there could listen: give --curve-key "
            "and --allow-clients (keys come from hertzline keys), or --insecure to allow it",
            options.endpoint));
    }
    if (options.duration_s) {
        require_positive("--duration", *options.duration_s);
    }
    if (!options.recording.empty()) {
        refuse_wrong_endings({&options.recording, 1});
    }
    (void)pace_of(options);
}

void refuse_stream_shortages(const StreamOptions& options, const StreamPlan& plan) {
    if (const auto shortage =
            memory_shortage("streaming this scene", Pipeline::memory_bytes(plan.scene, plan.pace))) {
        throw std::runtime_error(*shortage);
    }
    if (!options.recording.empty() && plan.samples) {
        const double bytes =
            recording_bytes(plan.scene, static_cast<double>(*plan.samples), RecordedBodies::outputs);
        if (const auto shortage = disk_shortage(options.recording, bytes)) {
            throw std::runtime_error(*shortage);
        }
    }
}

/// Where a listener of this machine connects to; everywhere else the host's name comes in place of 127.0.0.1.
std::string local_endpoint(std::string endpoint) {
    constexpr std::string_view every_interface = "//0.0.0.0:";
    if (const std::size_t at = endpoint.find(every_interface); at != std::string::npos) {
        endpoint.replace(at, every_interface.size(), "//127.0.0.1:");
    }
    return endpoint;
}

void announce(const Publisher& publisher, const Pipeline& pipeline, const StreamPlan& plan) {
    std::vector<std::string_view> streams;
    for (const Tap tap : taps_of(plan.scene.end.kind)) {
        streams.push_back(names_of(tap).name);
    }
    spdlog::info("endpoint {}", publisher.endpoint());
    spdlog::info("streams {}, float32 at {:g} Hz; meta, meters, end", fmt::join(streams, ", "),
                 plan.scene.output.sample_rate_hz);
    spdlog::info("run {}", pipeline.run_id());
    const bool encrypted = publisher.security() == Security::curve;
    spdlog::info("to listen: hertzline listen --connect {}{}", local_endpoint(publisher.endpoint()),
                 encrypted ? " --curve-key YOURS.key_secret --server-key OURS.key" : "");
    if (plan.start == StreamStart::with_first_subscriber) {
        spdlog::info("waiting for a subscriber");
    }
}

Json summarise(const StreamMeters& meters, const StreamPlan& plan, const Pipeline& pipeline,
               const Publisher& publisher) {
    Json summary;
    summary["simulated_s"] = meters.simulated_s;
    summary["wall_s"] = meters.wall_s;
    summary["real_time_factor"] = meters.real_time_factor();
    summary["steps"] = meters.steps;
    summary["step_s"] = *plan.scene.numerics.step_s;
    summary["integrator"] = word(*plan.scene.numerics.integrator);
    summary["estimated_error"] = number_or_null(plan.estimated_error);
    summary["contact_events"] = meters.contact_events;
    summary["energy_residual"] = meters.energy_residual;
    summary["samples"] = meters.samples;
    summary["frames"] = meters.frames;
    summary["late_frames"] = meters.late_frames;
    summary["dropped_frames"] = meters.dropped_frames;
    summary["load"] = meters.load;
    summary["endpoint"] = publisher.endpoint();
    summary["security"] = word(publisher.security());
    summary["refused_clients"] = publisher.refused_clients();
    summary["run"] = pipeline.run_id();
    summary["scene_hash"] = plan.scene_hash;
    summary["version"] = plan.version;
    return summary;
}

std::string stream_progress(const StreamMeters& meters, const StreamPlan& plan) {
    std::optional<double> goal_s;
    if (plan.samples) {
        goal_s = static_cast<double>(*plan.samples) / plan.scene.output.sample_rate_hz;
    }
    return fmt::format("{}, load {:.0f} %, {} late, {} dropped",
                       progress_text({meters.simulated_s, goal_s, meters.wall_s}), 100 * meters.load,
                       meters.late_frames, meters.dropped_frames);
}

Exit stream(const StreamOptions& options) {
    refuse_wrong_use(options);
    const std::optional<CurveServer> curve = curve_of(options.curve);
    const Resolved resolved = resolved_scene(options.scene);
    const StreamPlan plan{.scene = resolved.scene,
                          .scene_hash = scene_hash(resolved.scene),
                          .version = HERTZLINE_VERSION,
                          .estimated_error = resolved.estimated_error,
                          .pace = pace_of(options),
                          .samples = samples_of(options, resolved.scene),
                          .start = options.start,
                          .security = curve ? Security::curve : Security::none};
    refuse_stream_shortages(options, plan);
    const std::atomic<bool>& stop = stop_asked();
    PublisherOptions publisher_options = Pipeline::publisher_options(plan.scene);
    publisher_options.curve = curve;
    Publisher publisher(options.endpoint, all_topics, publisher_options);
    std::optional<Recorder> recorder;
    if (!options.recording.empty()) {
        recorder.emplace(options.recording, Chain(plan.scene), plan.scene.output.sample_rate_hz,
                         RecordedBodies::outputs);
    }
    Pipeline pipeline(plan, publisher, recorder ? &*recorder : nullptr);
    announce(publisher, pipeline, plan);

    ProgressLine line;
    Json summary;
    const auto show = [&](const StreamMeters& meters) {
        if (line.due()) {
            line.show(stream_progress(meters, plan));
        }
    };
    // Before subscribers hear of a good end the recording is complete: its failure is the stream's.
    const auto conclude = [&](const StreamMeters& meters) {
        if (recorder) {
            recorder->commit();
        }
        summary = summarise(meters, plan, pipeline, publisher);
        return json_text(summary);
    };
    pipeline.run(stop, show, conclude);
    line.clear();
    print_summary(summary, options.format);
    return Exit::done;
}

}  // namespace

Command stream_command(CLI::App& program) {
    auto options = std::make_shared<StreamOptions>();
    CLI::App* command =
        program.add_subcommand("stream", "simulate a scene in step with the clock and publish it");
    add_scene_options(*command, options->scene)->required();
    command->add_option("--bind", options->endpoint, "where to publish: tcp://HOST:PORT or ipc://PATH")
        ->type_name("ENDPOINT")
        ->capture_default_str();
    add_curve_options(*command, options->curve);
    command->add_flag_callback(
        "--insecure", [options] { options->exposure = Exposure::anything; },
        "let other machines connect without encryption");
    command->add_option("--pace", options->pace, "realtime, flat-out, or simulated seconds per second")
        ->type_name("PACE")
        ->capture_default_str();
    command->add_option("--duration", options->duration_s, "simulated seconds (default: until stopped)")
        ->type_name("S");
    command
        ->add_option("--record", options->recording,
                     "save the samples as well; the ending picks the format: .csv")
        ->check(missing_name)
        ->type_name("FILE");
    command->add_flag_callback(
        "--wait-for-subscriber", [options] { options->start = StreamStart::with_first_subscriber; },
        "hold sample 0 back until somebody subscribes to a stream");
    add_format_option(*command, options->format, "print the summary as one JSON object");
    command->footer(examples);
    return {command, [options] { return stream(*options); }};
}

}  // namespace hertzline::app
