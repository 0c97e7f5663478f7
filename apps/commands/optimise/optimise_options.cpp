#include "apps/commands/optimise/optimise_options.hpp"

#include <algorithm>
#include <charconv>
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

constexpr const char* examples =
    "MEASURE is a number of hertzline run's summary. A sample of the ranges is simulated first, then local "
    "searches begin at its best points, then more samples follow, until the evaluations are used up. FILE "
    "has all of them, as that of a sweep. The summary says how the best point differs from what other "
    "searches came to, and what it is worth 1 % and 5 % beside itself.\n"
    "Examples:\n"
    "  hertzline optimise paper-vitreous-carbon --vary end.thickness_m=0.1e-3..2e-3:log \\\n"
    "      --vary chain.preload_n=0.01..2:log --maximise occupied_20db_hz \\\n"
    "      --subject-to \"peak_v_out_m_per_s >= 0.3\" -o search.h5\n"
    "  hertzline optimise my-scene.toml --vary chain.spheres=3..12 --vary end.material=pyrex,acrylic \\\n"
    "      --minimise thd_r --evaluations 300 --seed 7 -o search.csv";

constexpr std::int64_t most_evaluations = 1'000'000;

std::optional<studies::Goal> goal_of(const OptimiseOptions& options, Faults& others) {
    Faults faults;
    if (options.maximise.empty() == options.minimise.empty()) {
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
    others.add(faults);
    return faults.none() ? std::optional(std::move(goal)) : std::nullopt;
}

void check_evaluations(const OptimiseOptions& options, std::int64_t fewest, std::size_t keys,
                       Faults& faults) {
    if (options.evaluations < fewest || options.evaluations > most_evaluations) {
        faults.add("--evaluations",
                   fmt::format("found {}, allowed: {} to {}{}", options.evaluations, fewest, most_evaluations,
                               keys == 0 ? "" : fmt::format(", where {} keys vary", keys)));
    }
}

/// A sweep over the ranges: its plan says whether they are right, its points what they take.
std::optional<SoundSweep> sound_sample(const OptimiseOptions& options, Faults& faults) {
    if (options.sweep.vary.empty()) {
        faults.add("--vary is missing: give KEY=FROM..TO[:lin|log] or KEY=A,B,C for each key that varies");
        return std::nullopt;
    }
    SweepOptions sample = options.sweep;
    sample.sobol = std::clamp<std::int64_t>(options.evaluations, 1, most_evaluations);
    if (sample.files.empty()) {  // a fault of its own
        sample.format = Format::json;
        sample.resume = false;
    }
    return sound_sweep(sample, faults);
}

/// A minus sign would be taken for a wrap-around.
std::string wrong_seed(const std::string& text) {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
    return error == std::errc() && end == text.data() + text.size()
               ? ""
               : fmt::format("found {}, allowed: a whole number from 0 to {}", quoted_briefly(text),
                             std::numeric_limits<std::uint64_t>::max());
}

}  // namespace

SoundSearch sound_search(const OptimiseOptions& options) {
    if (options.sweep.scene.scene.empty()) {
        throw WrongUse("SCENE is missing: give a scene file, or the name of a shipped scene");
    }
    Faults faults;
    if (options.sweep.files.empty()) {
        faults.add("-o FILE is missing: give a file that ends in .h5 or .csv");
    }
    std::optional<studies::Goal> goal = goal_of(options, faults);
    std::optional<SoundSweep> sample = sound_sample(options, faults);
    if (!sample) {
        check_evaluations(options, 1, 0, faults);
        faults.refuse<WrongUse>();
    }
    const studies::SearchSpace space(sample->sweep.plan.axes());
    check_evaluations(options, fewest_evaluations(space), space.keys(), faults);
    if (goal) {
        faults.add({}, studies::measure_faults(*goal, sample->sweep.demand.columns));
    }
    faults.refuse<WrongUse>();
    return {{sample->sweep.plan.base(), space.axes(), *std::move(goal), options.evaluations, options.seed,
             std::move(sample->sweep.demand)},
            std::move(sample->survey)};
}

void add_optimise_options(CLI::App& app, OptimiseOptions& options) {
    SweepOptions& sweep = options.sweep;
    add_scene_options(app, sweep.scene);
    add_repeatable_option(app, "--vary", sweep.vary,
                          "vary a key of the scene in a range or a list; repeatable")
        ->type_name("KEY=VALUES");
    app.add_option("--maximise", options.maximise, "look for the largest value of this measure")
        ->check(missing_name)
        ->type_name("MEASURE");
    app.add_option("--minimise", options.minimise, "look for the smallest one")
        ->check(missing_name)
        ->type_name("MEASURE");
    add_repeatable_option(app, "--subject-to", options.subject_to,
                          "only where a measure keeps to a bound: \"MEASURE >= NUMBER\", or <=; repeatable")
        ->type_name("BOUND");
    app.add_option("--evaluations", options.evaluations, "points that are simulated at most (default: 2000)")
        ->type_name("N");
    app.add_option("--seed", options.seed, "another one begins with other points (default: 1)")
        ->check(wrong_seed)
        ->type_name("S");
    add_point_options(app, sweep);
    app.add_flag("--resume", sweep.resume, "go on where a search was ended, or begin");
    add_format_option(app, sweep.format, "print the summary as JSON");
    app.footer(examples);
}

}  // namespace hertzline::app
