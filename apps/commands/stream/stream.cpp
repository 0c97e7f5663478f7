// hertzline stream: simulates a scene in step with the clock and publishes it.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
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
#include "core/model/drive.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "measures/resources.hpp"
#include "measures/scene_report.hpp"
#include "measures/tap_names.hpp"
#include "recordings/columns.hpp"
#include "recordings/recorded_drive.hpp"
#include "recordings/recording_formats.hpp"
#include "stream/inputs/live_drive.hpp"
#include "stream/inputs/simulation_source.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::app {

namespace {

constexpr const char* stream_examples =
    "Streams: v_out, v_last, v_plate, v_chain, v_horn, x_horn, f_first, f_last, f_chain, each as NAME/np and "
    "NAME/raw; "
    "of a modal plate v_centre, v_face, p_axis and p_points instead of v_plate.\n"
    "Further topics: meta, meters, end.\n"
    "Ctrl-C ends the stream with recordings saved and a summary.\n"
    "Examples:\n"
    "  hertzline stream paper-stream\n"
    "  hertzline stream paper-stream --pace 0.1 --bind ipc:///tmp/hertzline\n"
    "  hertzline stream paper-stream --record out.h5 --columns v_out,v_horn\n"
    "  hertzline stream paper-stream --control tcp://127.0.0.1:5574 --scope\n"
    "  hertzline stream paper-stream --drive tcp://127.0.0.1:5575 --set output.frame_samples=256\n"
    "  hertzline stream paper-wall --pace flat-out --duration 2e-3 --record wall.csv";

struct StreamOptions {
    SceneRequest scene;
    std::optional<std::string> drive;  ///< the endpoint of a live drive; unset: as the scene has it
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

void refuse_stream_shortages(const StreamOptions& arguments, const Scene& scene,
                             const stream::StreamOptions& options, const stream::PublisherOptions& publishing,
                             TapSet recorded) {
    const double memory = stream::SimulationSource::memory_bytes(scene) +
                          stream_bytes(stream::SimulationSource::format_of(scene), options.pace, publishing) +
                          memory_of_recordings(scene, recorded, arguments.recordings.size());
    throw_if(measures::memory_shortage("streaming this scene", memory));
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

bool is_live(const Scene& scene) noexcept {
    return scene.drive.kind == DriveKind::live;
}

/// The files that take the samples of a live drive: one in each folder with a recording, of the same name.
std::vector<std::filesystem::path> drive_files_of(const std::vector<std::string>& recordings) {
    std::vector<std::filesystem::path> files;
    for (const std::string& recording : recordings) {
        const std::filesystem::path file = std::filesystem::path(recording).replace_filename(
            recordings::drive_file_of(recordings.front()).filename());
        if (std::ranges::find(files, file) == files.end()) {
            files.push_back(file);
        }
    }
    return files;
}

/// A live drive is its stream's clock, and ends with it.
void check_live_drive(const StreamOptions& arguments, const Scene& scene, Faults& faults) {
    if (const auto fault = stream::LiveDrive::fault_of(scene.drive)) {
        faults.add(fault->message());
    }
    if (!awaits_samples(scene.drive)) {
        faults.add(
            "drive.kind: found a live drive that was recorded, allowed: hertzline run, which simulates it "
            "again");
    }
    for (const auto& file : drive_files_of(arguments.recordings)) {
        if (!is_utf8(file.filename().string())) {
            faults.add("--record: found " + quoted_briefly(file.filename().string()) +
                       " as the file of the input, which the recording tells, allowed: a name in UTF-8");
        }
        for (const std::string& recording : arguments.recordings) {
            if (recordings::share_files(recording, file)) {
                faults.add("--record: found " + quoted_briefly(recording) +
                           ", allowed: another name, as the input is saved there");
            }
        }
    }
    if (!arguments.control.endpoint.empty()) {
        faults.add("--control: found together with a live drive, allowed: with a drive that the scene has");
    }
    if (arguments.publish.pace != "realtime") {
        faults.add(
            "--pace: found together with a live drive, allowed: none, as the samples that come are the "
            "clock");
    }
    if (arguments.publish.on_overrun) {
        faults.add(
            "--on-overrun: found together with a live drive, allowed: none, as its sender is held back");
    }
}

/// The provenance of recordings: a live drive is described by the file with its samples.
Json recorded_provenance(Json about, const std::vector<std::filesystem::path>& drive_files) {
    if (!drive_files.empty()) {
        Json& drive = about["scene"]["drive"];
        drive["file"] = drive_files.front().filename().string();
        drive.erase("column");
    }
    return about;
}

/// @throws WrongUse with every fault
CheckedArguments checked(const StreamOptions& arguments) {
    Faults faults;
    CheckedArguments result;
    check_recordings(arguments.recordings, faults);
    check_inputs_stay("--record", arguments.recordings, files_of(arguments.scene), faults);
    result.curve = checked_curve(arguments.publish, faults);
    check_scope(arguments.scope, arguments.publish.curve, faults);
    result.control_curve = checked_control(arguments.control, arguments.publish.curve, faults);
    if (const std::string& control = arguments.control.endpoint;
        control == arguments.publish.endpoint && !control.ends_with(":0") && !control.ends_with(":*")) {
        faults.add("--control: found the endpoint of --bind, allowed: another");
    }
    if (arguments.recordings.empty() && !arguments.columns.empty()) {
        faults.add("--columns needs --record FILE to save to");
    }
    check_wav_scale(arguments.wav_scale, arguments.recordings, faults);
    auto resolved = faults.value_of({}, resolved_scene(arguments.scene, Lasting::endless));
    if (resolved && is_live(resolved->scene)) {
        check_live_drive(arguments, resolved->scene, faults);
    }
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
                                        const stream::StreamOptions& options) {
    if (arguments.control.endpoint.empty()) {
        return nullptr;
    }
    auto control = std::make_unique<LiveControl>(arguments.control, checked.control_curve, checked.resolved,
                                                 source, options.samples, options.start);
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
    if (is_live(scene)) {
        options.pace = stream::Pace::flat_out();
    }
    options.about = measures::provenance_json(asked.resolved, options.run);
    const stream::PublisherOptions publishing =
        publisher_options(arguments.publish, stream::SimulationSource::format_of(scene), asked.curve);
    refuse_stream_shortages(arguments, scene, options, publishing, asked.recorded);
    stop_asked();  // from here on there are files to be cleaned up
    const auto drive_files =
        is_live(scene) ? drive_files_of(arguments.recordings) : std::vector<std::filesystem::path>{};
    std::optional<recordings::DriveRecorder> drive_recorder;
    std::unique_ptr<stream::LiveDrive> live;
    if (is_live(scene)) {
        drive_recorder.emplace(drive_files, scene.drive, options.run);
        live = std::make_unique<stream::LiveDrive>(
            scene, [&](std::span<const float> samples) { drive_recorder->write(samples); });
        spdlog::info("drive {} with a latency of {} samples", live->endpoint(),
                     *stream::SimulationSource::format_of(scene).latency_samples);
        if (live->found_it_bound()) {
            spdlog::warn("another program has bound {}: the drive connects to it, as to a sender that binds",
                         live->endpoint());
        }
    }
    stream::SimulationSource source(scene, asked.recorded, live.get());
    const std::unique_ptr<LiveControl> control = control_of(arguments, asked, source, options);
    if (control) {
        control->add_to(options.about);
    }
    stream::Publisher publisher(arguments.publish.endpoint, stream::all_topics, publishing);
    ProgressLine line;
    recordings::RecordingSet recordings(
        arguments.recordings,
        {.columns = recordings::recorded_columns(asked.recorded, channel_counts(scene)),
         .sample_rate_hz = rate,
         .provenance = recorded_provenance(options.about, drive_files),
         .full_scale = arguments.wav_scale.value_or(1)},
        options.pace.is_flat_out() ? recordings::RecordingPatience::of_a_second(stop_asked())
                                   : recordings::RecordingPatience::none(stop_asked()),
        [&line](const std::string& text) {
            line.clear();
            spdlog::error("{}; the stream continues", text);
        });
    recordings::RowBuilder row_builder(recordings, asked.recorded);
    // Before the ring is made: a fork shares its pages, and each would fault when the simulating thread writes to it.
    const std::unique_ptr<ScopeChild> scope =
        scope_beside(arguments.scope, local_endpoint(publisher.endpoint()),
                     control ? local_endpoint(control->endpoint()) : std::string());
    stream::Pipeline pipeline(options, source, publisher, recordings.any_left() ? &row_builder : nullptr);
    StreamSession session(arguments.scene.scene, asked.resolved, options.about, recordings, line,
                          control.get());
    const auto end_drive = [&] {
        if (!live) {
            return true;
        }
        live->stop();  // it writes no more
        return drive_recorder->commit();
    };
    try {
        publish_to_the_end(pipeline, publisher, line, arguments.publish.format, session.callbacks());
    } catch (...) {
        recordings.commit();  // the samples up to here are complete
        end_drive();
        throw;
    }
    const bool drive_kept = end_drive();
    return recordings.complete() && drive_kept ? Exit::done : Exit::failed;
}

}  // namespace

Run stream_command(CLI::App& app) {
    auto arguments = std::make_shared<StreamOptions>();
    add_scene_options(app, arguments->scene)->required();
    app.add_option(
           "--drive", arguments->drive,
           "move the horn by the float32 samples that arrive at this endpoint (drive.kind = \"live\")")
        ->type_name("ENDPOINT");
    add_repeatable_option(app, "--record", arguments->recordings,
                          "save the samples as well; the ending picks the format: " +
                              recordings::recording_endings() + "; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    add_columns_option(app, arguments->columns, streamed_taps);
    add_wav_scale_option(app, arguments->wav_scale);
    add_publish_options(app, arguments->publish, "drop; where samples are recorded: wait");
    add_control_options(app, arguments->control);
    add_scope_child_options(app, arguments->scope);
    app.footer(stream_examples);
    return [arguments] {
        if (arguments->drive) {
            if (!is_utf8(*arguments->drive)) {
                throw WrongUse(
                    fmt::format("--drive: found {}, allowed: UTF-8", quoted_briefly(*arguments->drive)));
            }
            // before the user's, which may say more of the drive
            const std::vector<std::string> settings{"drive.kind=live",
                                                    "drive.endpoint=" + hertzline::quoted(*arguments->drive)};
            arguments->scene.settings.insert(arguments->scene.settings.begin(), settings.begin(),
                                             settings.end());
        }
        return stream(*arguments);
    };
}

}  // namespace hertzline::app
