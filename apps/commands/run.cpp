// hertzline run: a scene flat out, to files and a summary.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
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
#include "core/model/validity.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "stream/measures/record_warnings.hpp"
#include "stream/measures/spectrum.hpp"
#include "stream/measures/spectrum_json.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/recording_formats.hpp"
#include "stream/recordings/row_builder.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "wall_s and real_time_factor measure the simulation alone: no choice of the step, no files, no "
    "spectrum. docs/measures.md explains every number.\n"
    "Examples:\n"
    "  hertzline run paper-vitreous-carbon\n"
    "  hertzline run paper-wall -o wall.csv --set chain.spheres=7\n"
    "  hertzline run paper-vitreous-carbon --measure v_plate,f_last\n"
    "  hertzline run my-scene.toml --all -o all.csv --json";

struct RunOptions {
    SceneRequest scene;
    std::vector<std::string> files;
    std::vector<std::string> taps;      ///< to be recorded beside the usual ones
    std::vector<std::string> measures;  ///< taps to be measured beside v_out
    std::optional<double> band_from_hz;
    bool all_bodies = false;
    Format format = Format::text;
};

/// A tap's samples from the start to the end.
struct TapRecord {
    Tap tap;
    std::vector<double> values;
};

/// What is kept of a run for its summary.
struct RunRecord {
    std::vector<TapRecord> taps;       ///< v_out, then the others that are measured
    std::vector<double> v_out_smooth;  ///< with a plate: v_out as if the last contact never opened
    double peak_v_last = 0;
    stream::Nanoseconds busy{0};  // simulating
    bool stopped = false;

    std::size_t rows() const { return taps.front().values.size(); }
    double wall_s() const { return std::chrono::duration<double>(busy).count(); }
};

RunRecord empty_record(TapSet measured, const EndModel& end, std::size_t rows) {
    RunRecord record;
    record.taps.push_back({Tap::v_out, {}});
    for (const Tap tap : measured - Tap::v_out) {
        record.taps.push_back({tap, {}});
    }
    for (TapRecord& tap : record.taps) {
        tap.values.reserve(rows);
    }
    record.v_out_smooth.reserve(end.has_plate ? rows : 0);
    return record;
}

void keep(const Samples& block, const EndModel& end, RunRecord& record) {
    record.peak_v_last = std::max(record.peak_v_last, stream::peak_of(block[Tap::v_last]));
    for (TapRecord& tap : record.taps) {
        const std::span<const double> values = block[tap.tap];
        tap.values.insert(tap.values.end(), values.begin(), values.end());
    }
    if (end.has_plate) {
        std::ranges::transform(
            block[Tap::v_last], block[Tap::v_plate], std::back_inserter(record.v_out_smooth),
            [&end](double v_last, double v_plate) { return end.output_velocity(v_last, v_plate, true); });
    }
}

/// The taps of those names. @throws WrongUse that tells every name that is not allowed
TapSet named_taps(const char* option, const std::vector<std::string>& names, TapSet allowed) {
    Faults faults;
    TapSet taps;
    for (const std::string& name : names) {
        faults.of([&] { taps |= tap_argument(option, name, allowed); });
    }
    faults.refuse();
    return taps;
}

/// What has a peak and a spectrum of its own.
constexpr TapSet measurable_taps = taps_where([](const TapRow& row) { return row.extent == Extent::one; });

/// @throws WrongUse unless it is a frequency, or left out
void refuse_wrong_band(std::optional<double> from_hz) {
    if (from_hz && !(*from_hz >= 0 && std::isfinite(*from_hz))) {
        throw WrongUse(fmt::format("--band-from: found {}, allowed: a finite number from 0 [Hz]",
                                   number_text(*from_hz)));
    }
}

/// The taps that the recordings hold.
TapSet asked_taps(const RunOptions& options, TapSet named, EndKind end) {
    const TapSet taps = recorded_taps(end) | named;
    return options.all_bodies ? taps | Tap::v_chain | Tap::x_chain : taps;
}

RunRecord simulate(Simulation& simulation, TapSet recorded, TapSet measured,
                   stream::RecordingSet& recordings) {
    const Scene& scene = simulation.scene();
    stream::RowBuilder row_builder(recordings, recorded);
    const bool wants_files = recordings.any_left();
    const auto rows = static_cast<std::size_t>(rows_of_run(scene));
    Samples block = simulation.make_samples(block_of_run(scene, simulation.taps()));
    RunRecord record = empty_record(measured, simulation.chain().end, rows);
    ProgressLine line;
    const std::atomic<bool>& stop = stop_asked();
    const stream::Nanoseconds start = stream::MonotonicClock::now();
    while (record.rows() < rows) {
        if (stop) {
            record.stopped = true;
            return record;
        }
        const stream::Nanoseconds before = stream::MonotonicClock::now();
        const Status status = simulation.advance(block, std::min(block.capacity(), rows - record.rows()));
        const stream::Nanoseconds after = stream::MonotonicClock::now();
        record.busy += after - before;
        if (status == Status::stopped) {
            continue;  // to the look at `stop`
        }
        if (status != Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        keep(block, simulation.chain().end, record);
        row_builder.write(block);
        if (wants_files && !recordings.any_left()) {
            throw std::runtime_error("every recording has failed, so the run was stopped");
        }
        if (line.due()) {
            line.show(progress_text({static_cast<double>(record.rows()) / scene.output.sample_rate_hz,
                                     scene.output.duration_s,
                                     std::chrono::duration<double>(after - start).count()}));
        }
    }
    return record;
}

/// How much larger the harmonics of v_out are for the jumps of its formula [dB]; empty without a plate.
std::vector<double> switching_db(stream::SpectrumAnalyser& analyser, const stream::SpectrumSummary& v_out,
                                 const RunRecord& record) {
    if (record.v_out_smooth.empty()) {
        return {};
    }
    const auto smooth = analyser.analyse(record.v_out_smooth, v_out.fundamental_hz);
    return stream::level_differences_db(v_out.harmonics, smooth.harmonics);
}

/// Peaks and spectra, v_out's first. Warns of a record that shows less than it seems to.
std::vector<SummaryGroup> measure(const RunRecord& record, const Scene& scene,
                                  std::optional<double> band_from_hz) {
    stream::SpectrumAnalyser analyser(record.rows(), scene.output.sample_rate_hz);
    const std::vector<double>& v_out = record.taps.front().values;
    const auto spectrum = analyser.analyse(v_out, scene.drive.frequency_hz, band_from_hz);
    const std::vector<double> switching = switching_db(analyser, spectrum, record);
    for (const auto& warnings :
         {stream::record_warnings(scene, v_out), stream::switching_warnings(switching)}) {
        for (const std::string& text : warnings) {
            spdlog::warn(text);
        }
    }
    std::vector<SummaryGroup> groups{
        {"result",
         {{"peak_v_out_m_per_s", stream::peak_of(v_out)}, {"peak_v_last_m_per_s", record.peak_v_last}},
         ""},
        {"spectrum of v_out", stream::spectrum_json(spectrum), ""}};
    groups.back().values["switching_db"] = switching.empty() ? Json(nullptr) : Json(switching);
    for (const TapRecord& tap : std::span(record.taps).subspan(1)) {
        const TapRow& row = row_of(tap.tap);
        Json values{{fmt::format("peak_{}", row.column), stream::peak_of(tap.values)}};
        values.update(
            stream::spectrum_json(analyser.analyse(tap.values, scene.drive.frequency_hz, band_from_hz)));
        groups.push_back({std::string(row.name), std::move(values), std::string(row.name)});
    }
    return groups;
}

/// What the contacts carried. Warns where that is beyond Hertz's law.
SummaryGroup contacts(Simulation& simulation) {
    const ContactLoad load = contact_load(simulation.chain(), simulation.state().peak_overlap,
                                          simulation.scene().chain.diameter_m / 2);
    for (const std::string& text : validity_warnings(load)) {
        spdlog::warn(text);
    }
    Json values;
    values["peak_contact_force_n"] = load.force_n;
    values["peak_contact_pressure_pa"] = load.pressure_pa;
    values["peak_overlap_ratio"] = load.overlap_ratio;
    values["contact_events"] = simulation.contact_events();
    return {"contacts", std::move(values), ""};
}

/// How far the result can be trusted.
SummaryGroup trust(Simulation& simulation, const ResolvedScene& resolved) {
    Json values;
    stream::add_estimate(values, resolved.estimate);
    values["energy_residual"] = simulation.energy_residual();
    return {"trust", std::move(values), ""};
}

/// What was run, how long it took, and where it was saved.
SummaryGroup account(const Simulation& simulation, double setup_s, const RunRecord& record,
                     const stream::RecordingSet& recordings) {
    const Scene& scene = simulation.scene();
    const double simulated_s = static_cast<double>(record.rows() - 1) / scene.output.sample_rate_hz;
    const double wall_s = record.wall_s();
    Json values;
    values["simulated_s"] = simulated_s;
    values["rows"] = record.rows();
    values["integrator"] = word(*scene.numerics.integrator);
    values["step_s"] = simulation.step_s();
    values["steps"] = simulation.steps();
    values["setup_s"] = setup_s;
    values["wall_s"] = wall_s;
    values["real_time_factor"] = wall_s > 0 ? Json(simulated_s / wall_s) : Json(nullptr);
    values["recordings"] = stream::recordings_json(recordings);
    values["scene_hash"] = scene_hash(scene);
    values["version"] = stream::program_version();
    return {"run", std::move(values), ""};
}

Exit run(const RunOptions& options) {
    const stream::Nanoseconds start = stream::MonotonicClock::now();
    Faults faults;
    ResolvedScene resolved;
    TapSet named;
    TapSet measured;
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
    const TapSet there = scene_is_sound ? taps_of(scene.end.kind) : all_taps;
    faults.of([&] { named = named_taps("--tap", options.taps, there); });
    faults.of([&] { measured = named_taps("--measure", options.measures, there & measurable_taps); });
    faults.of([&] { refuse_wrong_band(options.band_from_hz); });
    faults.refuse();
    const TapSet recorded = asked_taps(options, named, scene.end.kind);
    refuse_shortages(scene, options.files, recorded, measured);
    stop_asked();  // from here on there are files to be cleaned up
    Simulation simulation(scene, {.taps = taps_of_run(scene, recorded | measured), .stop = &stop_asked()});
    const stream::RecordingHead head{
        .columns = stream::recorded_columns(recorded, static_cast<std::size_t>(scene.chain.spheres)),
        .sample_rate_hz = scene.output.sample_rate_hz,
        .provenance = stream::provenance_json(
            {scene, resolved.estimate, stream::utc_text(std::chrono::system_clock::now()), std::nullopt})};
    stream::RecordingSet recordings(
        options.files, head, stream::RecordingPatience::endless(stop_asked()),
        [](const std::string& text) { spdlog::error(text); }, stream::Appearance::when_complete);
    const double setup_s = std::chrono::duration<double>(stream::MonotonicClock::now() - start).count();
    const RunRecord record = simulate(simulation, recorded, measured, recordings);
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
    std::vector<SummaryGroup> summary = measure(record, scene, options.band_from_hz);
    summary.push_back(contacts(simulation));
    summary.push_back(trust(simulation, resolved));
    summary.push_back(account(simulation, setup_s, record, recordings));
    print_summary(summary, options.format);
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
    add_repeatable_option(
        app, "--measure", options->measures,
        "measure these outputs, too, as v_out: " + comma_separated(names_of(measurable_taps)))
        ->delimiter(',')
        ->type_name("NAME,...");
    app.add_option("--band-from", options->band_from_hz,
                   "bands are looked for from here upward (default: half the drive's frequency)")
        ->type_name("HZ");
    add_format_option(app, options->format, "print the summary as one JSON object");
    app.footer(examples);
    return [options] { return run(*options); };
}

}  // namespace hertzline::app
