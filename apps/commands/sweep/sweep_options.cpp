#include "apps/commands/sweep/sweep_options.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "measures/resources.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"
#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "apps/arguments/target_option.hpp"
#include "apps/command.hpp"
#include "apps/commands/sweep/shard_argument.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "A range is FROM..TO:COUNT[:lin|log], a list A,B,C. Several --vary make a grid, of which the last one "
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

constexpr int max_jobs = 1024;
constexpr double max_points_bytes = 1U << 30;

[[noreturn]] void refuse(const std::vector<Fault>& faults) {
    throw WrongUse(fault_text(faults));
}

std::string points_text(const std::string& name) {
    recordings::InputFile file(name);
    if (static_cast<double>(file.size()) > max_points_bytes) {
        throw WrongUse(fmt::format("--points: found {} bytes, allowed: at most {} bytes", file.size(),
                                   number_text(max_points_bytes)));
    }
    std::string text = file.text(file.size(), "the points");
    if (text.empty()) {
        throw WrongUse(printable(name) + ": found an empty file, allowed: a line of keys, then points");
    }
    return text;
}

/// Refuses --set of a key that varies.
void refuse_set_keys(const SweepOptions& options, const studies::SweepPlan& plan) {
    Faults faults;
    for (const std::string& setting : options.scene.settings) {
        const std::string key(trimmed(std::string_view(setting).substr(0, setting.find('=')), " \t"));
        if (std::ranges::find(plan.keys(), key, &SceneKey::name) != plan.keys().end()) {
            faults.of([&] {
                throw WrongUse(fmt::format("--set {}: found a key that varies, allowed: one that does not",
                                           printable(setting)));
            });
        }
    }
    faults.refuse();
}

studies::SweepPlan plan_of(const SweepOptions& options) {
    const ParsedScene base = parsed_scene(options.scene);
    studies::PlanRequest request{options.vary, "", printable(options.points), options.sobol};
    if (!options.points.empty()) {
        request.points = points_text(options.points);
    }
    auto plan = studies::SweepPlan::make(base.scene, request);
    if (!plan) {
        refuse(plan.error());
    }
    refuse_set_keys(options, *plan);
    return *std::move(plan);
}

std::vector<studies::NumberColumn> columns_of(const SweepOptions& options, TapSet measured, bool modal) {
    auto columns = measures::chosen_columns(measures::number_columns(measured, modal), options.quantities);
    if (!columns) {
        std::string text;
        for (const std::string& fault : columns.error()) {
            text += (text.empty() ? "--quantity: " : "\n--quantity: ") + fault;
        }
        throw WrongUse(text);
    }
    return *std::move(columns);
}

void refuse_wrong_output(const SweepOptions& options) {
    refuse_no_output(options);
    if (options.files.empty() && (options.resume || !options.shard.empty())) {
        throw WrongUse(fmt::format("{} needs -o FILE", options.resume ? "--resume" : "--shard"));
    }
    if (options.files.empty() && !options.waveform.empty()) {
        throw WrongUse("--waveforms needs -o FILE.h5");
    }
    for (const std::string& file : options.files) {
        std::error_code there_is_none;
        if (!options.points.empty() && std::filesystem::equivalent(file, options.points, there_is_none)) {
            throw WrongUse(
                fmt::format("-o {}: found the file of --points, allowed: another file", printable(file)));
        }
    }
    refuse_wrong_tables(options.files, options.waveform.empty() ? std::nullopt : std::optional(Tap::v_out));
}

}  // namespace

void refuse_no_output(const SweepOptions& options) {
    if (options.files.empty() && options.format == Format::text) {
        throw WrongUse("-o FILE is missing: give a file that ends in .h5 or .csv, or --json");
    }
}

void refuse_wrong_tables(std::span<const std::string> files, std::optional<Tap> waveform) {
    recordings::Table table;
    table.columns.push_back({{"status", "", ""}, recordings::CellKind::text});
    if (waveform) {
        table.samples.emplace();
    }
    Faults faults;
    std::set<std::filesystem::path> names;
    for (const std::string& file : files) {
        faults.of([&] {
            if (const auto fault = recordings::table_fault(file, table)) {
                throw WrongUse(*fault + (waveform ? ", which holds waveforms" : ""));
            }
            if (!names.insert(recordings::recording_name(file)).second) {
                throw WrongUse(
                    fmt::format("{}: found a second time, allowed: each file once", printable(file)));
            }
        });
    }
    faults.refuse();
}

int jobs_of(const SweepOptions& options) {
    if (!options.jobs && options.shard == "mpi") {
        return 1;  // the ranks of a machine share its processors
    }
    if (!options.jobs) {
        return std::min(measures::usable_processors(), max_jobs);
    }
    if (*options.jobs < 1 || *options.jobs > max_jobs) {
        throw WrongUse(fmt::format("--jobs: found {}, allowed: 1 to {}", *options.jobs, max_jobs));
    }
    return *options.jobs;
}

ValidatedSweep validated_sweep(const SweepOptions& options) {
    Faults faults;
    std::optional<studies::SweepPlan> plan;
    studies::Shard shard;
    faults.of([&] { refuse_wrong_output(options); });
    faults.of([&] { jobs_of(options); });
    faults.of([&] { shard = shard_argument(options.shard); });
    faults.of([&] { refuse_wrong_band(options.band_from_hz); });
    faults.of([&] { plan = plan_of(options); });
    studies::PlanSummary summary =
        plan ? studies::summary_of(*plan, measures::measurable_among(options.measures))
             : studies::PlanSummary{};
    const TapSet there = summary.measurable();
    studies::PointOptions point_options;
    point_options.band_from_hz = options.band_from_hz;
    point_options.waveform_samples = options.waveform.empty() ? 0 : static_cast<std::size_t>(summary.rows);
    faults.of([&] { point_options.measured = tap_arguments("--measure", options.measures, there); });
    faults.of([&] {
        if (!options.waveform.empty()) {
            point_options.waveform = tap_argument("--waveforms", options.waveform, there);
        }
    });
    faults.of([&] {
        point_options.columns = columns_of(
            options, (point_options.measured | measures::measured_unasked) & (there | point_options.measured),
            summary.modal);
    });
    faults.refuse();
    summary.memory_bytes += sizeof(float) * static_cast<double>(point_options.waveform_samples);
    return {{*std::move(plan), std::move(point_options), shard}, std::move(summary)};
}

void add_point_options(CLI::App& app, SweepOptions& options) {
    add_repeatable_option(app, "-o,--output", options.files, "the table: .h5 or .csv; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    add_repeatable_option(app, "--measure", options.measures,
                          "measure these outputs beside v_out, as run does")
        ->delimiter(',')
        ->type_name("NAME,...");
    app.add_option("--band-from", options.band_from_hz,
                   "lower limit of the bands (default: half the drive's frequency)")
        ->type_name("HZ");
    app.add_option("--jobs", options.jobs,
                   "threads (default: one for each usable processor; one with --shard mpi)")
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
        ->type_name("NAME,...");
    app.add_option("--waveforms", options.waveform, "keep the samples of this output as float32, in .h5 only")
        ->check(missing_name)
        ->type_name("NAME");
    app.add_flag("--resume", options.resume, "continue an unfinished sweep, or start one");
    app.add_option("--shard", options.shard,
                   "run part I of N, or the part of this task of a Slurm array or rank of mpirun or srun; "
                   "--merge joins the parts")
        ->check(missing_name)
        ->type_name("I/N|slurm[/N]|mpi");
    app.add_option("--merge", options.parts, "write FILE from the journals of all parts")
        ->expected(1, -1)
        ->type_name("JOURNAL");
    add_format_option(app, options.format, "print the rows as JSON, a line each");
    app.footer(examples);
}

}  // namespace hertzline::app
