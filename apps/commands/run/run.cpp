// hertzline run: a scene flat out, to files and a summary.

#include "measures/run.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/plot/picture.hpp"
#include "apps/commands/preflight.hpp"
#include "apps/commands/run/run_changes.hpp"
#include "apps/commands/run/run_files.hpp"
#include "apps/console/output.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "measures/measuring.hpp"
#include "measures/provenance.hpp"
#include "measures/quantities.hpp"
#include "measures/tap_names.hpp"
#include "recordings/columns.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/named_scene.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* run_examples =
    "wall_s and real_time_factor measure the simulation alone: no choice of the step, no files, no "
    "spectrum. docs/measures.md explains every number.\n"
    "Examples:\n"
    "  hertzline run paper-vitreous-carbon\n"
    "  hertzline run paper-wall -o wall.csv --set chain.spheres=7\n"
    "  hertzline run paper-vitreous-carbon -o force.csv --columns v_out,f_last\n"
    "  hertzline run paper-vitreous-carbon --measure v_plate --spectrum lines.csv\n"
    "  hertzline run paper-wall --measure f_last --plot wall.png\n"
    "  hertzline run my-scene.toml --all -o all.csv --json\n"
    "A recording in place of SCENE is simulated again, with the changes that its stream went through:\n"
    "  hertzline run session.h5 -o again.h5";

struct RunOptions {
    SceneRequest scene;
    std::string changes;  ///< a file; empty: the scene stays as it is
    std::vector<std::string> files;
    std::vector<std::string> columns;   ///< taps to be recorded; none: the usual ones
    std::vector<std::string> taps;      ///< to be recorded beside those
    std::vector<std::string> measures;  ///< taps to be measured beside v_out
    std::optional<double> band_from_hz;
    std::optional<double> wav_scale;
    std::vector<std::string> spectra;  ///< files
    std::string picture;               ///< a file; empty: none
    bool all_bodies = false;
    Format format = Format::text;
};

using measures::measurable_taps;

/// Returns the taps that the recordings hold.
TapSet asked_taps(const RunOptions& options, TapSet columns, TapSet beside, const Scene& scene) {
    const TapSet taps = (options.columns.empty() ? recorded_taps(scene) : columns) | beside;
    return options.all_bodies ? taps | Tap::v_chain | Tap::x_chain : taps;
}

/// Checks before the run that files written after it can be written. @throws std::runtime_error
void refuse_unwritable(const RunOptions& options) {
    for (const std::string& file : options.spectra) {
        recordings::require_writable(file);
    }
    if (!options.picture.empty()) {
        recordings::require_writable(options.picture);
    }
}

/// Shows the progress of a run on a terminal.
class RunProgress {
public:
    explicit RunProgress(const Scene& scene) : scene_(scene) {}

    void add(std::size_t rows) {
        rows_ += rows;
        if (line_.due()) {
            const std::chrono::duration<double> elapsed = Clock::now() - start_;
            line_.show(progress_text({static_cast<double>(rows_) / scene_.output.sample_rate_hz,
                                      scene_.output.duration_s, elapsed.count()}));
        }
    }

private:
    const Scene& scene_;
    ProgressLine line_;
    Clock::time_point start_ = Clock::now();
    std::size_t rows_ = 0;
};

hertzline::Run simulate(const Session& session, TapSet recorded, TapSet measured,
                        recordings::RecordingSet& recordings) {
    recordings::RowBuilder row_builder(recordings, recorded);
    const bool wants_files = recordings.any_left();
    RunProgress progress(session.resolved.scene);
    return measures::simulate(
        session.resolved,
        {.recorded = recorded,
         .measured = measured,
         .stop = &stop_asked(),
         .take =
             [&](const Samples& block) {
                 row_builder.write(block);
                 if (wants_files && !recordings.any_left()) {
                     throw std::runtime_error("every recording has failed, so the run was stopped");
                 }
                 progress.add(block.count);
                 return true;
             },
         .steps = session.steps,
         .live = session.drive,
         .threads = usable_threads(),
         .begins =
             [&](std::size_t step) { recordings.note_change(stream::change_json(session.changes[step])); }});
}

void measure(hertzline::Run& run, std::optional<double> band_from_hz) {
    SpectrumAnalyser analyser(run.rows(), run.scene().output.sample_rate_hz);
    measures::measure(run, &analyser, band_from_hz, nullptr);
    for (const std::string& text : run.warnings) {
        spdlog::warn(text);
    }
}

/// Prints the numbers of a run, and as JSON its warnings, which text has on stderr.
void print_run(const hertzline::Run& run, const Session& session, Format format) {
    std::vector<SummaryGroup> summary = measures::summary_of(run);
    if (format == Format::json) {
        Warnings warnings = measures::scene_warnings(session.resolved);
        warnings.insert(warnings.end(), session.warnings.begin(), session.warnings.end());
        warnings.insert(warnings.end(), run.warnings.begin(), run.warnings.end());
        summary.push_back({"", {{"warnings", warnings}}, ""});
    }
    print_summary(summary, format);
}

/// Returns the session that SCENE names, a scene or a recording, or adds its faults.
std::optional<Session> session_of(const RunOptions& options, Faults& faults) {
    if (!recordings::is_recording(options.scene.scene)) {
        return session_of_scene(options.scene, options.changes, faults);
    }
    if (!options.changes.empty()) {
        faults.add("--changes: found together with a recording, which has its own; allowed: with a scene");
        return std::nullopt;
    }
    return session_of_recording(options.scene, faults);
}

/// The request of the options. recorded and measured: taps.
struct CheckedRun {
    Session session;
    TapSet recorded;
    TapSet measured;
};

/// @throws WrongUse with every fault
CheckedRun checked(const RunOptions& options) {
    Faults faults;
    check_recordings(options.files, faults);
    if (options.files.empty() && !(options.columns.empty() && options.taps.empty())) {
        faults.add(
            fmt::format("{} needs -o FILE to save to", options.columns.empty() ? "--tap" : "--columns"));
    }
    check_spectra(options.spectra, options.files, faults);
    std::vector<std::string> inputs = files_of(options.scene);
    inputs.push_back(options.changes);
    check_inputs_stay("-o", options.files, inputs, faults);
    check_inputs_stay("--spectrum", options.spectra, inputs, faults);
    if (!options.picture.empty()) {
        faults.add("--plot", picture_fault(options.picture));
    }
    check_wav_scale(options.wav_scale, options.files, faults);
    std::optional<Session> session = session_of(options, faults);
    const TapSet there = session ? taps_of(session->resolved.scene) : all_taps;
    if (options.all_bodies && session && !there.contains(Tap::v_chain)) {
        faults.add(
            "--all",
            "found with an array, allowed: with a single chain: an array has no outputs of each sphere");
    }
    const TapSet columns = measures::taps_named("--columns", options.columns, there, faults);
    const TapSet beside = measures::taps_named("--tap", options.taps, there, faults);
    const TapSet measured =
        measures::taps_named("--measure", options.measures, there & measurable_taps, faults);
    faults.add("--band-from", measures::band_from_fault(options.band_from_hz));
    faults.refuse<WrongUse>();
    const Scene& scene = session->resolved.scene;
    const TapSet recorded = asked_taps(options, columns, beside, scene);
    return {*session, recorded, measures::measured_taps(scene, measured)};
}

Exit run(const RunOptions& options) {
    const auto start = Clock::now();
    const auto [session, recorded, measured] = checked(options);
    const Resolution& resolved = session.resolved;
    const Scene& scene = resolved.scene;
    refuse_unwritable(options);
    refuse_shortages(scene, {options.files, recorded, options.spectra, measured});
    stop_asked();  // from here on there are files to be cleaned up
    Json provenance = measures::provenance_json(resolved);
    if (!session.changes.empty()) {
        provenance["control"] = true;
        provenance["changes"] = Json::array();
    }
    const recordings::RecordingHead head{
        .columns = recordings::recorded_columns(recorded, channel_counts(scene)),
        .sample_rate_hz = scene.output.sample_rate_hz,
        .provenance = provenance,
        .full_scale = options.wav_scale.value_or(1)};
    recordings::RecordingSet recordings(
        options.files, head, recordings::RecordingPatience::endless(stop_asked()),
        [](const std::string& text) { spdlog::error(text); }, recordings::Appearance::when_complete);
    const double setup_s = std::chrono::duration<double>(Clock::now() - start).count();
    hertzline::Run run = simulate(session, recorded, measured, recordings);
    if (session.drive && !session.drive->failure().empty()) {
        throw std::runtime_error(session.drive->failure());
    }
    run.setup_s += setup_s;
    if (run.stopped) {
        recordings.discard();
        spdlog::error("stopped before the end; nothing was saved");
        return Exit::failed;
    }
    recordings.commit();
    for (const std::string& text : recordings.warnings()) {
        spdlog::warn(text);
    }
    end_at_once_when_asked();  // the spectrum of a long run takes long
    if (stop_was_asked()) {
        spdlog::error("stopped before the summary");
        return Exit::failed;
    }
    bool saved = save_spectra(options.spectra, run, head.provenance);
    saved = !stop_was_asked() &&
            save_picture(options.picture, run, head.provenance, options.scene.scene, options.band_from_hz) &&
            saved;
    if (stop_was_asked()) {
        spdlog::error("stopped before the summary");
        return Exit::failed;
    }
    run.recordings = recordings::recordings_json(recordings.status());
    measure(run, options.band_from_hz);
    const std::vector<std::string> of_files = recordings.warnings();  // which stderr has had
    run.warnings.insert(run.warnings.end(), of_files.begin(), of_files.end());
    print_run(run, session, options.format);
    return recordings.complete() && saved ? Exit::done : Exit::failed;
}

}  // namespace

Run run_command(CLI::App& app) {
    auto options = std::make_shared<RunOptions>();
    add_scene_options(app, options->scene)->required();
    app.add_option("--changes", options->changes,
                   "change the scene on the way as a stream was changed: a JSON list of {\"sample\": N, "
                   "\"set\": {KEY: "
                   "VALUE}}")
        ->check(missing_name)
        ->type_name("FILE");
    add_repeatable_option(
        app, "-o,--output", options->files,
        "save the samples; the ending picks the format: " + recordings::recording_endings() + "; repeatable")
        ->type_name("FILE");
    add_columns_option(app, options->columns, all_taps);
    app.add_flag("--all", options->all_bodies, "save every sphere's displacement and velocity too");
    add_repeatable_option(
        app, "--tap", options->taps,
        "save this output too; repeatable: " + comma_separated(measures::names_of(all_taps)))
        ->type_name("OUTPUT");
    add_wav_scale_option(app, options->wav_scale);
    add_repeatable_option(
        app, "--measure", options->measures,
        "measure these outputs, too, as v_out: " + comma_separated(measures::names_of(measurable_taps)))
        ->delimiter(',')
        ->type_name("OUTPUT,...");
    add_repeatable_option(
        app, "--spectrum", options->spectra,
        "save the spectra of v_out and of the outputs of --measure: " + recordings::table_endings())
        ->check(missing_name)
        ->type_name("FILE");
    app.add_option(
           "--plot", options->picture,
           "draw v_out and the outputs of --measure, and their spectra: .png, .svg or .pdf; needs Python "
           "with matplotlib")
        ->check(missing_name)
        ->type_name("FILE");
    app.add_option("--band-from", options->band_from_hz,
                   "lower limit of the bands (default: half the drive's frequency)")
        ->type_name("HZ");
    add_target_option(app);
    add_format_option(app, options->format, "print the summary as one JSON object");
    app.footer(run_examples);
    return [options] { return run(*options); };
}

}  // namespace hertzline::app
