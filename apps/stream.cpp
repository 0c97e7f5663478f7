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
#include "stream/provenance.hpp"
#include "stream/recorder.hpp"
#include "stream/recording_formats.hpp"
#include "stream/resources.hpp"
#include "stream/simulation_source.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "Streams: v_out, v_last, v_plate, v_chain, each as NAME/np and NAME/raw; topics meta, meters, end.\n"
    "Ctrl-C ends the stream with recordings saved and a summary.\n"
    "Examples:\n"
    "  hertzline stream paper-stream\n"
    "  hertzline stream paper-stream --pace 0.1 --bind ipc:///tmp/hertzline\n"
    "  hertzline stream paper-wall --pace flat-out --duration 2e-3 --wait-for-subscriber --record wall.csv";

struct StreamOptions {
    SceneRequest scene;
    std::string endpoint = "tcp://127.0.0.1:5573";
    CurveServerRequest curve;
    std::string pace = "realtime";
    std::optional<double> duration_s;
    std::vector<std::string> recordings;
    StreamStart start = StreamStart::at_once;
    std::string on_overrun;  // empty: drop, or wait where something is recorded
    ThreadWishes thread;
    Format format = Format::text;
};

Pace pace_of(const StreamOptions& options) {
    const Expected<Pace> pace = parse_pace(options.pace);
    if (!pace) {
        throw WrongUse("--pace: " + pace.error());
    }
    return *pace;
}

OnOverrun on_overrun(const StreamOptions& options) {
    const bool drop = options.on_overrun.empty() ? options.recordings.empty() : options.on_overrun == "drop";
    return drop ? OnOverrun::drop : OnOverrun::wait;
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
    if (options.duration_s) {
        require_positive("--duration", *options.duration_s);
    }
    refuse_wrong_files(options.recordings);
    if (options.thread.cpu) {
        if (const auto fault = cpu_fault(*options.thread.cpu)) {
            throw WrongUse("--cpu: " + *fault);
        }
    }
    (void)pace_of(options);
}

void refuse_shortages(const StreamOptions& options, const Scene& scene, const StreamPlan& plan) {
    const double memory = SimulationSource::memory_bytes(scene) +
                          Pipeline::ring_bytes(SimulationSource::format_of(scene), plan.pace);
    if (const auto shortage = memory_shortage("streaming this scene", memory)) {
        throw std::runtime_error(*shortage);
    }
    if (plan.samples) {
        refuse_disk_shortages(scene, static_cast<double>(*plan.samples), options.recordings,
                              RecordedBodies::outputs);
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

void announce(const Publisher& publisher, const Pipeline& pipeline) {
    std::vector<std::string_view> streams;
    for (const Tap tap : pipeline.format().taps) {
        streams.push_back(names_of(tap).name);
    }
    spdlog::info("endpoint {}", publisher.endpoint());
    spdlog::info("streams {}, float32 at {:g} Hz; meta, meters, end", fmt::join(streams, ", "),
                 pipeline.format().sample_rate_hz);
    spdlog::info("run {}", pipeline.run_id());
    const bool encrypted = publisher.security() == Security::curve;
    spdlog::info("to listen: hertzline listen --connect {}{}", local_endpoint(publisher.endpoint()),
                 encrypted ? " --curve-key YOURS.key_secret --server-key OURS.key" : "");
    if (pipeline.plan().start == StreamStart::with_first_subscriber) {
        spdlog::info("waiting for a subscriber");
    }
}

/// Of the samples: what meta and recordings say.
Json about(const Resolved& resolved, const std::string& run) {
    return provenance_json(
        {resolved.scene, resolved.estimated_error, utc_text(std::chrono::system_clock::now()), run});
}

Json summarise(const StreamMeters& meters, const Resolved& resolved, const Pipeline& pipeline,
               const Publisher& publisher, const Recordings& recordings) {
    Json summary;
    add_stream_members(summary, meters, pipeline.format().taps);
    summary["samples"] = meters.samples;
    summary["dropped_frames"] = meters.dropped_frames;
    summary["steps"] = meters.account.steps;
    summary["step_s"] = *resolved.scene.numerics.step_s;
    summary["integrator"] = word(*resolved.scene.numerics.integrator);
    summary["estimated_error"] = number_or_null(resolved.estimated_error);
    summary["endpoint"] = publisher.endpoint();
    summary["security"] = word(publisher.security());
    summary["refused_clients"] = publisher.refused_clients();
    summary["run"] = pipeline.run_id();
    summary["recordings"] = recordings_json(recordings);
    summary["scene_hash"] = scene_hash(resolved.scene);
    summary["version"] = program_version();
    return summary;
}

std::string stream_progress(const StreamMeters& meters, const Pipeline& pipeline) {
    std::optional<double> goal_s;
    if (pipeline.plan().samples) {
        goal_s = static_cast<double>(*pipeline.plan().samples) / pipeline.format().sample_rate_hz;
    }
    return fmt::format("{}, load {:.0f} %, {} late, {} dropped",
                       progress_text({meters.simulated_s, goal_s, meters.wall_s}), 100 * meters.load,
                       meters.late_frames, meters.dropped_frames);
}

Exit stream(const StreamOptions& options) {
    refuse_wrong_use(options);
    const std::optional<CurveServer> curve = curve_of(options.curve, options.endpoint);
    const Resolved resolved = resolved_scene(options.scene);
    const std::string run = make_run_id();
    const StreamPlan plan{.run = run,
                          .about = about(resolved, run),
                          .pace = pace_of(options),
                          .samples = samples_of(options, resolved.scene),
                          .start = options.start,
                          .on_overrun = on_overrun(options),
                          .thread = options.thread};
    refuse_shortages(options, resolved.scene, plan);
    const std::atomic<bool>& stop = stop_asked();
    SimulationSource source(resolved.scene, !options.recordings.empty());
    PublisherOptions publisher_options = Pipeline::publisher_options(source.format());
    publisher_options.curve = curve;
    Publisher publisher(options.endpoint, all_topics, publisher_options);
    ProgressLine line;
    const RecordingHead head{.columns = recorded_columns(resolved.scene, RecordedBodies::outputs),
                             .sample_rate_hz = resolved.scene.output.sample_rate_hz,
                             .provenance = plan.about};
    Recordings recordings(options.recordings, head, [&line](const std::string& text) {
        line.clear();
        spdlog::error("{}; the stream goes on", text);
    });
    Recorder recorder(recordings, RecordedBodies::outputs);
    Pipeline pipeline(plan, source, publisher, recordings.any_left() ? &recorder : nullptr);
    announce(publisher, pipeline);

    Json summary;
    const StreamEvents events{.progress =
                                  [&](const StreamMeters& meters) {
                                      if (line.due()) {
                                          line.show(stream_progress(meters, pipeline));
                                      }
                                  },
                              .warn =
                                  [&](const std::string& text) {
                                      line.clear();
                                      spdlog::warn(text);
                                  },
                              // Before subscribers hear of the end the recordings are complete, or known not
                              // to be.
                              .summary =
                                  [&](const StreamMeters& meters) {
                                      recordings.commit();
                                      summary =
                                          summarise(meters, resolved, pipeline, publisher, recordings);
                                      return json_text(summary);
                                  }};
    pipeline.run(stop, events);
    line.clear();
    print_summary(summary, options.format);
    return recordings.sound() ? Exit::done : Exit::failed;
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
    command->add_option("--pace", options->pace, "realtime, flat-out, or simulated seconds per second")
        ->type_name("PACE")
        ->capture_default_str();
    command->add_option("--duration", options->duration_s, "simulated seconds (default: until stopped)")
        ->type_name("S");
    add_repeatable_option(
        *command, "--record", options->recordings,
        "save the samples as well; the ending picks the format: " + recording_endings() + "; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    command->add_flag_callback(
        "--wait-for-subscriber", [options] { options->start = StreamStart::with_first_subscriber; },
        "hold sample 0 back until somebody subscribes to a stream");
    command
        ->add_option("--on-overrun", options->on_overrun,
                     "what becomes of a frame whose time has passed while the program was held up: drop (and "
                     "count) it, or wait and fall behind (default: drop, with --record wait)")
        ->check(CLI::IsMember({"drop", "wait"}))
        ->type_name("WORD");
    command->add_flag(
        "--realtime-priority", options->thread.realtime_priority,
        "let the simulating thread run before ordinary ones, and keep memory from being swapped");
    command->add_option("--cpu", options->thread.cpu, "keep the simulating thread on this processor")
        ->type_name("N");
    add_format_option(*command, options->format, "print the summary as one JSON object");
    command->footer(examples);
    return {command, [options] { return stream(*options); }};
}

}  // namespace hertzline::app
