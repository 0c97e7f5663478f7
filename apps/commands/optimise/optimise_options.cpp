#include "apps/commands/optimise/optimise_options.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

constexpr const char* optimise_examples =
    "MEASURE is a number of hertzline run's summary. A sample of the ranges is simulated first, then local "
    "searches start from its best points, then larger samples follow, until the evaluations are used up. "
    "FILE "
    "has all of them, as a table of a sweep. The summary compares the best point with the results of other "
    "local searches, and gives the values 1 % and 5 % away from it.\n"
    "Examples:\n"
    "  hertzline optimise paper-vitreous-carbon --vary end.thickness_m=0.1e-3..2e-3:log \\\n"
    "      --vary chain.preload_n=0.01..2:log --maximise occupied_20db_hz \\\n"
    "      --subject-to \"peak_v_out_m_per_s >= 0.3\" -o search.h5\n"
    "  hertzline optimise my-scene.toml --vary chain.spheres=3..12 --vary end.material=pyrex,acrylic \\\n"
    "      --minimise thd_r --evaluations 300 --seed 7 -o search.csv";

/// The goal as far as it can be read; nothing where it has no measure. Adds the faults.
std::optional<studies::Goal> goal_of(const OptimiseOptions& options, Faults& faults) {
    const bool has_measure = options.maximise.empty() != options.minimise.empty();
    if (!has_measure) {
        faults.add(options.maximise.empty() ? "--maximise or --minimise is missing: give one MEASURE"
                                            : "--maximise and --minimise: found both, allowed: one of them");
    }
    const bool maximise = options.minimise.empty();
    studies::Goal goal{maximise ? options.maximise : options.minimise, maximise, {}};
    for (const std::string& text : options.subject_to) {
        if (auto constraint = faults.value_of("--subject-to", studies::parse_constraint(text))) {
            goal.constraints.push_back(*std::move(constraint));
        }
    }
    return has_measure ? std::optional(std::move(goal)) : std::nullopt;
}

/// Returns a sweep over the ranges, which checks them and estimates the memory of points. Or adds the faults.
std::optional<ValidatedSweep> validated_sample(const OptimiseOptions& options, Faults& faults) {
    if (options.sweep.vary.empty()) {
        faults.add("--vary is missing: give KEY=FROM..TO[:lin|log] or KEY=A,B,C for each key that varies");
        return std::nullopt;
    }
    SweepOptions sample = options.sweep;
    sample.sobol = std::clamp<std::int64_t>(options.evaluations, 1, studies::most_evaluations);
    if (sample.files.empty()) {  // a fault of its own
        sample.format = Format::json;
        sample.resume = false;
    }
    return validated_sweep(sample, faults);
}

/// Refuses a minus sign, too, which CLI11 would wrap around.
std::string wrong_seed(const std::string& text) {
    return parsed_number<std::uint64_t>(text)
               ? ""
               : fmt::format("found {}, allowed: a whole number from 0 to {}", quoted_briefly(text),
                             std::numeric_limits<std::uint64_t>::max());
}

}  // namespace

ValidatedSearch validated_search(const OptimiseOptions& options) {
    if (options.sweep.scene.scene.empty()) {
        throw WrongUse("SCENE is missing: give a scene file, or the name of a shipped scene");
    }
    Faults faults;
    if (options.sweep.files.empty()) {
        faults.add("-o FILE is missing: give a file that ends in .h5 or .csv");
    }
    std::optional<studies::Goal> goal = goal_of(options, faults);
    std::optional<ValidatedSweep> sample = validated_sample(options, faults);
    if (!sample) {
        if (options.evaluations < 1 || options.evaluations > studies::most_evaluations) {
            faults.add("--evaluations", fmt::format("found {}, allowed: 1 to {}", options.evaluations,
                                                    studies::most_evaluations));
        }
        faults.refuse<WrongUse>();
    }
    const studies::SearchSpace space(sample->study.plan.axes());
    faults.add("--evaluations", studies::evaluations_fault(options.evaluations, space));
    if (goal) {
        for (const studies::SearchFault& fault :
             studies::measure_faults(*goal, sample->study.options.columns)) {
            faults.add(fmt::format("--{}", fault.subject), fault.text);
        }
    }
    faults.refuse<WrongUse>();
    ValidatedSearch search{{sample->study.plan.base(), space.axes(), *std::move(goal), options.evaluations,
                            options.seed, std::move(sample->study.options)},
                           std::move(sample->summary)};
    search.request.records = std::move(sample->study.records);
    return search;
}

void add_optimise_options(CLI::App& app, OptimiseOptions& options) {
    SweepOptions& sweep = options.sweep;
    add_scene_options(app, sweep.scene);
    add_repeatable_option(app, "--vary", sweep.vary,
                          "vary a key of the scene in a range or a list; repeatable")
        ->type_name("KEY=VALUES");
    app.add_option("--maximise", options.maximise, "find the largest value of this measure")
        ->check(missing_name)
        ->type_name("MEASURE");
    app.add_option("--minimise", options.minimise, "find the smallest value of this measure")
        ->check(missing_name)
        ->type_name("MEASURE");
    add_repeatable_option(app, "--subject-to", options.subject_to,
                          "keep a measure within a bound: \"MEASURE >= NUMBER\", or <=; repeatable")
        ->type_name("BOUND");
    app.add_option("--evaluations", options.evaluations, "the most points that are simulated (default: 2000)")
        ->type_name("N");
    app.add_option("--seed", options.seed, "another seed starts from other points (default: 1)")
        ->check(wrong_seed)
        ->type_name("S");
    add_point_options(app, sweep);
    app.add_flag("--resume", sweep.resume, "continue a search, or start one");
    add_format_option(app, sweep.format, "print the summary as JSON");
    app.footer(optimise_examples);
}

}  // namespace hertzline::app
