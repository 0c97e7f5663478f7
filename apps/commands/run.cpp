// hertzline run: a scene flat out, to files and a summary.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/preflight.hpp"
#include "apps/console/output.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/recording_formats.hpp"
#include "stream/recordings/row_builder.hpp"
#include "stream/spectrum.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "wall_s and real_time_factor measure the simulation alone: no choice of the step, no files, no "
    "spectrum.\n"
    "Examples:\n"
    "  hertzline run paper-vitreous-carbon\n"
    "  hertzline run paper-wall -o wall.csv --set chain.spheres=7\n"
    "  hertzline run my-scene.toml --all -o all.csv --json";

struct RunOptions {
    SceneRequest scene;
    std::vector<std::string> files;
    std::vector<std::string> taps;  ///< to be recorded beside the usual ones
    bool all_bodies = false;
    Format format = Format::text;
};

/// What is kept of a run for its summary.
struct RunRecord {
    std::vector<double> v_out;
    double peak_v_last = 0;
    double peak_v_out = 0;
    stream::Nanoseconds busy{0};  // simulating
    bool stopped = false;

    double wall_s() const { return std::chrono::duration<double>(busy).count(); }
};

void keep(const Samples& block, RunRecord& record) {
    const auto peak_of = [&block](Tap tap, double peak) {
        for (const double value : block[tap]) {
            peak = std::max(peak, std::abs(value));
        }
        return peak;
    };
    record.peak_v_last = peak_of(Tap::v_last, record.peak_v_last);
    record.peak_v_out = peak_of(Tap::v_out, record.peak_v_out);
    record.v_out.insert(record.v_out.end(), block[Tap::v_out].begin(), block[Tap::v_out].end());
}

/// The taps of those names. @throws WrongUse that tells every name that is not allowed
TapSet named_taps(const std::vector<std::string>& names, TapSet allowed) {
    Faults faults;
    TapSet taps;
    for (const std::string& name : names) {
        faults.of([&] { taps |= tap_argument("--tap", name, allowed); });
    }
    faults.refuse();
    return taps;
}

/// The taps that the recordings hold.
TapSet asked_taps(const RunOptions& options, TapSet named, EndKind end) {
    const TapSet taps = recorded_taps(end) | named;
    return options.all_bodies ? taps | Tap::v_chain | Tap::x_chain : taps;
}

RunRecord simulate(Simulation& simulation, TapSet recorded, stream::RecordingSet& recordings) {
    const Scene& scene = simulation.scene();
    stream::RowBuilder row_builder(recordings, recorded);
    const bool wants_files = recordings.any_left();
    const auto rows = static_cast<std::size_t>(rows_of_run(scene));
    Samples block = simulation.make_samples(block_of_run(scene, simulation.taps()));
    RunRecord record;
    record.v_out.reserve(rows);
    ProgressLine line;
    const std::atomic<bool>& stop = stop_asked();
    const stream::Nanoseconds start = stream::MonotonicClock::now();
    while (record.v_out.size() < rows) {
        if (stop) {
            record.stopped = true;
            return record;
        }
        const stream::Nanoseconds before = stream::MonotonicClock::now();
        const Status status =
            simulation.advance(block, std::min(block.capacity(), rows - record.v_out.size()));
        const stream::Nanoseconds after = stream::MonotonicClock::now();
        record.busy += after - before;
        if (status == Status::stopped) {
            continue;  // to the look at `stop`
        }
        if (status != Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        keep(block, record);
        row_builder.write(block);
        if (wants_files && !recordings.any_left()) {
            throw std::runtime_error("every recording has failed, so the run was stopped");
        }
        if (line.due()) {
            line.show(progress_text({static_cast<double>(record.v_out.size()) / scene.output.sample_rate_hz,
                                     scene.output.duration_s,
                                     std::chrono::duration<double>(after - start).count()}));
        }
    }
    return record;
}

void add_spectrum(Json& summary, const RunRecord& record, const Scene& scene) {
    stream::SpectrumAnalyser analyser(record.v_out.size(), scene.output.sample_rate_hz);
    const stream::SpectrumSummary spectrum = analyser.analyse(record.v_out, scene.drive.frequency_hz);
    const auto edge = [](const std::optional<stream::Band>& band, double stream::Band::*side) {
        return band ? Json((*band).*side) : Json(nullptr);
    };
    const auto width = [](const std::optional<stream::Band>& band) {
        return band ? Json(band->width_hz()) : Json(nullptr);
    };
    summary["fundamental_hz"] = spectrum.fundamental_hz;
    summary["harmonics_db"] = spectrum.harmonics_db.empty() ? Json(nullptr) : Json(spectrum.harmonics_db);
    summary["subharmonic_db"] = number_or_null(spectrum.subharmonic_db);
    summary["thd_r"] = number_or_null(spectrum.thd_r);
    summary["bandwidth_6db_hz"] = width(spectrum.band_6db);
    summary["band_6db_low_hz"] = edge(spectrum.band_6db, &stream::Band::low_hz);
    summary["band_6db_high_hz"] = edge(spectrum.band_6db, &stream::Band::high_hz);
    summary["bandwidth_20db_hz"] = width(spectrum.band_20db);
    summary["band_20db_low_hz"] = edge(spectrum.band_20db, &stream::Band::low_hz);
    summary["band_20db_high_hz"] = edge(spectrum.band_20db, &stream::Band::high_hz);
}

Json summarise(Simulation& simulation, double setup_s, const RunRecord& record, const ResolvedScene& resolved,
               const stream::RecordingSet& recordings) {
    const Scene& scene = resolved.scene;
    const double simulated_s = static_cast<double>(record.v_out.size() - 1) / scene.output.sample_rate_hz;
    const double wall_s = record.wall_s();
    Json summary;
    summary["simulated_s"] = simulated_s;
    summary["setup_s"] = setup_s;
    summary["wall_s"] = wall_s;
    summary["real_time_factor"] = wall_s > 0 ? Json(simulated_s / wall_s) : Json(nullptr);
    summary["steps"] = simulation.steps();
    summary["step_s"] = simulation.step_s();
    summary["integrator"] = word(*scene.numerics.integrator);
    stream::add_estimate(summary, resolved.estimate);
    summary["contact_events"] = simulation.contact_events();
    summary["energy_residual"] = simulation.energy_residual();
    summary["peak_v_last_m_per_s"] = record.peak_v_last;
    summary["peak_v_out_m_per_s"] = record.peak_v_out;
    add_spectrum(summary, record, scene);
    summary["rows"] = record.v_out.size();
    summary["recordings"] = stream::recordings_json(recordings);
    summary["scene_hash"] = scene_hash(scene);
    summary["version"] = stream::program_version();
    return summary;
}

Exit run(const RunOptions& options) {
    const stream::Nanoseconds start = stream::MonotonicClock::now();
    Faults faults;
    ResolvedScene resolved;
    TapSet named;
    bool scene_is_sound = false;
    faults.of([&] { refuse_wrong_files(options.files); });
    faults.of([&] {
        if (options.files.empty() && !options.taps.empty()) {
            throw WrongUse("--tap: found no -o FILE to save it to, allowed: together with -o");
        }
    });
    faults.of([&] {
        resolved = resolved_scene(options.scene);
        scene_is_sound = true;
    });
    const Scene& scene = resolved.scene;
    faults.of([&] { named = named_taps(options.taps, scene_is_sound ? taps_of(scene.end.kind) : all_taps); });
    faults.refuse();
    const TapSet recorded = asked_taps(options, named, scene.end.kind);
    refuse_shortages(scene, options.files, recorded);
    stop_asked();  // from here on there are files to be cleaned up
    Simulation simulation(scene, {.taps = taps_of_run(recorded), .stop = &stop_asked()});
    const stream::RecordingHead head{
        .columns = stream::recorded_columns(recorded, static_cast<std::size_t>(scene.chain.spheres)),
        .sample_rate_hz = scene.output.sample_rate_hz,
        .provenance = stream::provenance_json(
            {scene, resolved.estimate, stream::utc_text(std::chrono::system_clock::now()), std::nullopt})};
    stream::RecordingSet recordings(
        options.files, head, stream::RecordingPatience::endless(stop_asked()),
        [](const std::string& text) { spdlog::error(text); }, stream::Appearance::when_complete);
    const double setup_s = std::chrono::duration<double>(stream::MonotonicClock::now() - start).count();
    const RunRecord record = simulate(simulation, recorded, recordings);
    if (record.stopped) {
        recordings.discard();
        spdlog::error("stopped before the end; nothing was saved");
        return Exit::failed;
    }
    recordings.commit();
    end_at_once_when_asked();  // the spectrum of a long run takes long
    if (stop_was_asked()) {
        spdlog::error("stopped before the summary");
        return Exit::failed;
    }
    print_summary(summarise(simulation, setup_s, record, resolved, recordings), options.format);
    return recordings.sound() ? Exit::done : Exit::failed;
}

}  // namespace

Run run_command(CLI::App& app) {
    auto options = std::make_shared<RunOptions>();
    add_scene_options(app, options->scene)->required();
    add_repeatable_option(
        app, "-o,--output", options->files,
        "save the samples; the ending picks the format: " + stream::recording_endings() + "; repeatable")
        ->type_name("FILE");
    app.add_flag("--all", options->all_bodies, "save every sphere's displacement and velocity too");
    add_repeatable_option(app, "--tap", options->taps,
                          "save this output too; repeatable: " + comma_separated(names_of(all_taps)))
        ->type_name("NAME");
    add_format_option(app, options->format, "print the summary as one JSON object");
    app.footer(examples);
    return [options] { return run(*options); };
}

}  // namespace hertzline::app
