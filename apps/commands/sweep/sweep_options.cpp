#include "apps/commands/sweep/sweep_options.hpp"

#include <algorithm>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "apps/commands/sweep/shard_argument.hpp"
#include "core/scene/scene_settings.hpp"
#include "core/scene/text.hpp"
#include "measures/tap_names.hpp"
#include "recordings/drive_record.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/workers.hpp"

namespace hertzline::app {

namespace {

constexpr const char* sweep_examples =
    "A range is FROM..TO:COUNT[:lin|log]; a list is A,B,C. Several --vary make a grid, of which the last one "
    "varies fastest. A row of the file is a point: the keys that vary, status, the numbers of hertzline run, "
    "and a message. A point that cannot be simulated is a row with its reason. FILE.journal holds the rows "
    "until all points are finished.\n"
    "Examples:\n"
    "  hertzline sweep paper-vitreous-carbon --vary end.thickness_m=0.1e-3..2e-3:log:30 -o thickness.csv\n"
    "  hertzline sweep paper-vitreous-carbon --vary chain.preload_n=0.01..2:log:30 \\\n"
    "      --vary end.material=vitreous_carbon,pyrex,aluminium -o map.h5\n"
    "  hertzline sweep my-scene.toml --points designs.csv --quantity peak_v_out_m_per_s --json\n"
    "  hertzline sweep my-scene.toml --vary chain.preload_n=0.01..2:log --sobol 1000 -o s.h5 --shard 1/4\n"
    "  hertzline sweep --merge s.h5.*-of-4.journal -o s.h5";

constexpr double max_points_bytes = 1U << 30;

/// Reads the file of points, or adds its fault.
std::optional<std::string> points_text(const std::string& name, Faults& faults) {
    recordings::InputFile file(name);
    if (static_cast<double>(file.size()) > max_points_bytes) {
        faults.add("--points", fmt::format("found {} bytes, allowed: at most {} bytes", file.size(),
                                           number_text(max_points_bytes)));
        return std::nullopt;
    }
    std::string text = file.text(file.size(), "the points");
    if (text.empty()) {
        faults.add(printable(name), "found an empty file, allowed: a line of keys, then points");
        return std::nullopt;
    }
    return text;
}

/// Adds the faults of --set of a key that varies.
void check_set_keys(const SweepOptions& options, const studies::SweepPlan& plan, Faults& faults) {
    for (const std::string& setting : options.scene.settings) {
        const std::string key =
            full_key(trimmed(std::string_view(setting).substr(0, setting.find('=')), " \t"));
        if (std::ranges::find(plan.keys(), key, &SceneKey::name) != plan.keys().end()) {
            faults.add("--set " + printable(setting), "found a key that varies, allowed: one that does not");
        }
    }
}

/// Reads the scene that the points change. One that lacks what varies has the values of the first point.
std::optional<ParsedScene> base_scene(const SweepOptions& options, const studies::PlanRequest& plan,
                                      Faults& faults) {
    auto alone = parsed_scene(options.scene);
    if (alone) {
        return *std::move(alone);
    }
    std::vector<std::string> first = studies::first_settings(plan);
    std::erase_if(first, [](std::string_view setting) {  // points read their records themselves
        return setting.starts_with("drive.file=");
    });
    SceneRequest completed = options.scene;
    completed.settings.insert(completed.settings.end(), first.begin(), first.end());
    auto with_first = parsed_scene(completed);
    const bool lacks_these_alone = std::ranges::all_of(alone.error(), [&](const Fault& fault) {
        return std::ranges::any_of(
            first, [&](std::string_view setting) { return setting.starts_with(fault.key + '='); });
    });
    return faults.value_of({}, with_first || lacks_these_alone ? std::move(with_first) : std::move(alone));
}

/// @param frequency_given whether records that vary leave drive.frequency_hz as it is
std::optional<studies::SweepPlan> plan_of(const SweepOptions& options, bool& frequency_given,
                                          Faults& faults) {
    studies::PlanRequest request{options.vary, "", printable(options.points), options.sobol};
    if (!options.points.empty()) {
        auto points = points_text(options.points, faults);
        if (!points) {
            return std::nullopt;
        }
        request.points = *std::move(points);
    }
    const auto base = base_scene(options, request, faults);
    if (!base) {
        return std::nullopt;
    }
    auto plan = faults.value_of({}, studies::SweepPlan::make(base->scene, request));
    if (plan) {
        frequency_given = recordings::gives_frequency(*base) || studies::varies(*plan, "drive.frequency_hz");
        check_set_keys(options, *plan, faults);
    }
    return plan;
}

void check_files(const SweepOptions& options, Faults& faults) {
    if (options.files.empty() && options.format == Format::text) {
        check_output(options, faults);
        return;
    }
    if (options.files.empty() && (options.resume || !options.shard.empty())) {
        faults.add(fmt::format("{} needs -o FILE", options.resume ? "--resume" : "--shard"));
        return;
    }
    if (options.files.empty() && !options.waveform.empty()) {
        faults.add("--waveforms needs -o FILE.h5");
        return;
    }
    check_tables(options.files, options.waveform.empty() ? std::nullopt : std::optional(Tap::v_out), faults);
}

}  // namespace

void check_output(const SweepOptions& options, Faults& faults) {
    if (options.files.empty() && options.format == Format::text) {
        faults.add("-o FILE is missing: give a file that ends in .h5 or .csv, or --json");
    }
}

void check_tables(std::span<const std::string> files, std::optional<Tap> waveform, Faults& faults) {
    recordings::Table table;
    table.columns.push_back({{"status", "", ""}, recordings::CellKind::text});
    if (waveform) {
        table.samples.emplace();
    }
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (const auto fault = recordings::table_fault(files[i], table)) {
            faults.add(*fault + (waveform ? ", which holds waveforms" : ""));
        } else {
            faults.add(recordings::repeated_fault(files[i], files.first(i)));
        }
    }
}

int jobs_of(const SweepOptions& options) {
    if (!options.jobs && options.shard == "mpi") {
        return 1;  // the ranks of a machine share its processors
    }
    return options.jobs.value_or(studies::usual_jobs());
}

std::optional<ValidatedSweep> validated_sweep(const SweepOptions& options, Faults& others) {
    Faults faults;
    check_files(options, faults);
    faults.add("--jobs", studies::jobs_fault(jobs_of(options)));
    const auto shard = faults.value_of({}, shard_argument(options.shard));
    faults.add("--band-from", measures::band_from_fault(options.band_from_hz));
    studies::PointOptions point_options;
    std::optional<studies::SweepPlan> plan = plan_of(options, point_options.frequency_given, faults);
    Json records = plan ? studies::varied_records(*plan) : Json();
    std::vector<std::string> inputs = files_of(options.scene);
    inputs.push_back(options.points);
    for (const auto& [file, hash] : records.items()) {
        inputs.push_back(file);
    }
    check_inputs_stay("-o", options.files, inputs, faults);
    studies::PlanSummary summary =
        plan ? studies::summary_of(*plan, measures::measurable_among(options.measures))
             : studies::PlanSummary{};
    const TapSet there = summary.measurable();
    point_options.band_from_hz = options.band_from_hz;
    point_options.measured = measures::taps_named("--measure", options.measures, there, faults);
    if (!options.waveform.empty()) {
        studies::keep_waveforms(point_options, options.waveform, summary, "--waveforms", faults);
    }
    const TapSet measured =
        (point_options.measured | measures::measured_unasked) & (there | point_options.measured);
    auto columns = faults.value_of(
        "--quantity",
        measures::chosen_columns(measures::number_columns(measured, summary.modal), options.quantities));
    if (!faults.none()) {
        others.add(faults);
        return std::nullopt;
    }
    point_options.columns = *std::move(columns);
    summary.memory_bytes += sizeof(float) * static_cast<double>(point_options.waveform_size());
    return ValidatedSweep{{*std::move(plan), std::move(point_options), *shard, nullptr, std::move(records)},
                          std::move(summary)};
}

void add_point_options(CLI::App& app, SweepOptions& options) {
    add_repeatable_option(app, "-o,--output", options.files, "the table: .h5 or .csv; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    add_repeatable_option(app, "--measure", options.measures,
                          "measure these outputs in addition to v_out, as run does")
        ->delimiter(',')
        ->type_name("OUTPUT,...");
    app.add_option("--band-from", options.band_from_hz,
                   "lower limit of the bands (default: half the drive's frequency)")
        ->type_name("HZ");
    app.add_option("--jobs", options.jobs, "threads (default: one for each usable processor)")
        ->type_name("N");
    add_target_option(app);
}

void add_sweep_options(CLI::App& app, SweepOptions& options) {
    add_scene_options(app, options.scene);
    add_repeatable_option(app, "--vary", options.vary,
                          "vary a key of the scene over a range or a list; repeatable")
        ->type_name("KEY=VALUES");
    app.add_option("--points", options.points, "run the points of a CSV: a line of keys, then values")
        ->check(missing_name)
        ->type_name("FILE");
    app.add_option("--sobol", options.sobol, "run N points of Sobol's sequence in the ranges, not a grid")
        ->type_name("N");
    add_point_options(app, options);
    add_repeatable_option(app, "--quantity", options.quantities,
                          "keep only these numbers of run's summary (default: all)")
        ->delimiter(',')
        ->type_name("QUANTITY,...");
    app.add_option("--waveforms", options.waveform, "keep the samples of this output as float32, in .h5 only")
        ->check(missing_name)
        ->type_name("OUTPUT");
    app.add_flag("--resume", options.resume, "continue an unfinished sweep, or start one");
    app.add_option(
           "--shard", options.shard,
           "run part I of N, or the part of this task of a Slurm array or rank of mpirun or srun (mpi: on "
           "one thread); --merge joins the parts")
        ->check(missing_name)
        ->type_name("I/N|slurm[/N]|mpi");
    app.add_option("--merge", options.parts, "write FILE from the journals of all parts")
        ->expected(1, -1)
        ->type_name("JOURNAL");
    add_format_option(app, options.format, "print the rows as JSON, a line each");
    app.footer(sweep_examples);
}

}  // namespace hertzline::app
