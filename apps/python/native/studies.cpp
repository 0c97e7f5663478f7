#include "apps/python/native/studies.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "measures/resources.hpp"
#include "studies/search_job.hpp"
#include "studies/search_report.hpp"
#include "studies/study.hpp"
#include "studies/workers.hpp"
#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/python_values.hpp"
#include "apps/python/native/scene_object.hpp"
#include "core/scene/text.hpp"

namespace hertzline::python {

namespace {

constexpr int max_jobs = 1024;

/// Values of a key as Python gives them: a range as text, numbers, integers or words.
using Values =
    std::variant<std::string, py::array_t<double>, py::array_t<std::int64_t>, std::vector<std::string>>;
using KeysAndValues = std::vector<std::pair<std::string, Values>>;

/// The same without Python's objects.
struct VariedKey {
    std::string key;
    std::string range;  ///< empty: a list
    std::vector<SceneValue> list;
};

/// The arguments that sweeps and searches share.
struct StudyArguments {
    std::vector<std::string> measure;
    std::vector<std::string> quantities;
    std::optional<double> band_from_hz;
    std::optional<std::string> waveforms;
    std::optional<int> jobs;
};

struct SearchArguments {
    std::string maximise;  ///< a measure; empty: none
    std::string minimise;
    std::vector<std::string> subject_to;
    std::int64_t evaluations;
    std::uint64_t seed;
};

/// A column of the table, from the first point to the last.
using TableColumn = std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>>;

struct StudyRows {
    std::vector<TableColumn> columns;
    std::vector<float> waveforms;  ///< row-major, [point][sample]
};

std::vector<SceneValue> scene_values(const std::string& /*range*/) {
    return {};
}

std::vector<SceneValue> scene_values(const std::vector<std::string>& words) {
    return {words.begin(), words.end()};
}

/// @param numbers contiguous
template <class Number>
std::vector<SceneValue> scene_values(const py::array_t<Number>& numbers) {
    return {numbers.data(), numbers.data() + numbers.size()};
}

std::vector<VariedKey> varied_keys(const KeysAndValues& keys) {
    std::vector<VariedKey> varied;
    varied.reserve(keys.size());
    for (const auto& [key, values] : keys) {
        const auto* range = std::get_if<std::string>(&values);
        varied.push_back({key, range != nullptr ? *range : "",
                          std::visit([](const auto& list) { return scene_values(list); }, values)});
    }
    return varied;
}

using Axes = tl::expected<std::vector<studies::Axis>, std::vector<Fault>>;
using Plan = tl::expected<studies::SweepPlan, std::vector<Fault>>;

/// Returns the axes or every fault. Needs no GIL.
Axes axes_of(const Scene& scene, const std::vector<VariedKey>& keys, studies::Sampling sampling) {
    std::vector<studies::Axis> axes;
    std::vector<Fault> faults;
    for (const VariedKey& varied : keys) {
        auto axis = varied.list.empty()
                        ? studies::parse_axis(scene, varied.key + '=' + varied.range, sampling)
                        : studies::axis_of(scene, varied.key, varied.list);
        if (axis) {
            axes.push_back(*std::move(axis));
        } else {
            std::ranges::move(axis.error(), std::back_inserter(faults));
        }
    }
    return faults.empty() ? Axes(std::move(axes)) : tl::unexpected(std::move(faults));
}

Plan plan_of_axes(const Scene& scene, const std::vector<VariedKey>& keys, std::optional<std::int64_t> sobol) {
    auto axes = axes_of(scene, keys, sobol ? studies::Sampling::anywhere : studies::Sampling::grid);
    return axes ? studies::SweepPlan::make(scene, *std::move(axes), sobol)
                : tl::unexpected(std::move(axes).error());
}

Plan plan_of_points(const Scene& scene, std::vector<VariedKey> keys) {
    std::vector<studies::PointColumn> columns;
    columns.reserve(keys.size());
    for (VariedKey& key : keys) {
        columns.push_back({std::move(key.key), std::move(key.list)});
    }
    return studies::points_of(scene, columns).map([&](studies::PointList points) {
        return studies::SweepPlan::of_points(scene, std::move(points));
    });
}

int jobs_of(const StudyArguments& arguments, ArgumentFaults& faults) {
    const int jobs = arguments.jobs.value_or(std::min(measures::usable_processors(), max_jobs));
    if (jobs < 1 || jobs > max_jobs) {
        faults.add("jobs: found " + number_text(std::int64_t{jobs}) + ", allowed: 1 to " +
                   number_text(std::int64_t{max_jobs}));
    }
    return jobs;
}

/// Returns the measurements of each point, and adds their faults.
studies::PointOptions options_of(const StudyArguments& arguments, const studies::PlanSummary& summary,
                                 ArgumentFaults& faults) {
    const TapSet there = summary.measurable();
    studies::PointOptions options;
    options.measured = taps_named("measure", arguments.measure, there, faults);
    options.band_from_hz = arguments.band_from_hz;
    if (const auto fault = measures::band_from_fault(options.band_from_hz)) {
        faults.add("band_from_hz: " + *fault);
    }
    if (arguments.waveforms) {
        const TapSet tap = taps_named("waveforms", {*arguments.waveforms}, there, faults);
        options.waveform = tap.empty() ? std::nullopt : std::optional<Tap>(*tap.begin());
        options.waveform_samples = static_cast<std::size_t>(summary.rows);
    }
    auto columns = measures::chosen_columns(
        measures::number_columns((options.measured | measures::measured_unasked) & there, summary.modal),
        arguments.quantities);
    if (columns) {
        options.columns = *std::move(columns);
    } else {
        for (const std::string& fault : columns.error()) {
            faults.add("quantities: " + fault);
        }
    }
    return options;
}

std::vector<TableColumn> empty_columns(const recordings::Table& table) {
    std::vector<TableColumn> columns;
    for (const recordings::TableColumn& column : table.columns) {
        switch (column.kind) {
            case recordings::CellKind::integer:
                columns.emplace_back(std::vector<std::int64_t>());
                break;
            case recordings::CellKind::number:
                columns.emplace_back(std::vector<double>());
                break;
            case recordings::CellKind::text:
                columns.emplace_back(std::vector<std::string>());
                break;
        }
    }
    return columns;
}

StudyRows rows_of(const recordings::Table& table) {
    StudyRows rows{empty_columns(table), {}};
    recordings::TableRow row;
    for (std::int64_t point = 0; point < table.rows; ++point) {
        table.read(point, row);
        for (std::size_t i = 0; i < row.cells.size(); ++i) {
            std::visit(
                [&](auto& cell) {
                    std::get<std::vector<std::decay_t<decltype(cell)>>>(rows.columns[i]).push_back(cell);
                },
                row.cells[i]);
        }
        rows.waveforms.insert(rows.waveforms.end(), row.samples.begin(), row.samples.end());
    }
    return rows;
}

py::object python_column(TableColumn& column) {
    if (auto* integers = std::get_if<std::vector<std::int64_t>>(&column)) {
        return array_of(std::move(*integers));
    }
    if (auto* numbers = std::get_if<std::vector<double>>(&column)) {
        return array_of(std::move(*numbers));
    }
    return py::cast(std::get<std::vector<std::string>>(column));
}

/// ([(name, unit, values)], waveforms or None, provenance)
py::tuple python_table(const studies::Study& study, StudyRows& rows) {
    const std::vector<recordings::TableColumn> about = studies::columns_of(study);
    py::list columns;
    for (std::size_t i = 0; i < rows.columns.size(); ++i) {
        columns.append(
            py::make_tuple(about[i].about.name, about[i].about.unit, python_column(rows.columns[i])));
    }
    py::object waveforms = py::none();
    if (study.options.waveform) {
        waveforms =
            array_of(std::move(rows.waveforms), {static_cast<py::ssize_t>(study.plan.size()),
                                                 static_cast<py::ssize_t>(study.options.waveform_samples)});
    }
    return py::make_tuple(columns, waveforms, python_object(studies::provenance_of(study)));
}

void require_memory_of_study(const char* study, double points, const studies::Study& rows, int jobs,
                             const studies::PlanSummary& summary) {
    const double kept = studies::Journal::bytes(points, studies::columns_of(rows), rows.samples());
    require_memory(study, jobs * summary.memory_bytes + 2 * kept);
}

py::tuple sweep(const std::function<Plan()>& make_plan, const StudyArguments& arguments) {
    ArgumentFaults faults;
    const int jobs = jobs_of(arguments, faults);
    std::optional<Plan> plan;
    studies::PlanSummary summary;
    interruptible([&](const std::atomic<bool>&) {
        plan = make_plan();
        if (*plan) {
            summary = studies::summary_of(**plan, measures::measurable_among(arguments.measure));
        }
    });
    if (!*plan) {
        faults.add(fault_text(std::move(*plan).error()));
        faults.refuse();
    }
    studies::PointOptions options = options_of(arguments, summary, faults);
    faults.refuse();
    const studies::Study wanted{**std::move(plan), std::move(options), {}};
    require_memory_of_study("the sweep", static_cast<double>(wanted.plan.size()), wanted, jobs, summary);
    StudyRows rows;
    with_os_errors([&] {
        interruptible([&](const std::atomic<bool>& stop) {
            studies::Journal journal = studies::Journal::in_memory();
            journal.begin(studies::journal_text(wanted), studies::columns_of(wanted));
            studies::load_rows(journal, wanted);
            std::vector<std::int64_t> points(static_cast<std::size_t>(wanted.plan.size()));
            std::iota(points.begin(), points.end(), std::int64_t{0});
            studies::run_points(wanted, journal, points, jobs, stop, [](const studies::PointCounts&) {});
            if (!stop) {
                rows = rows_of(studies::table_of(wanted, std::span(&journal, 1)));
            }
        });
    });
    return python_table(wanted, rows);
}

studies::Goal goal_of(const SearchArguments& arguments, ArgumentFaults& faults) {
    const bool maximise = !arguments.maximise.empty();
    if (maximise == !arguments.minimise.empty()) {
        faults.add(maximise ? "maximise and minimise: found both, allowed: one of them"
                            : "maximise or minimise is missing: give the name of a number");
    }
    studies::Goal goal{maximise ? arguments.maximise : arguments.minimise, maximise, {}};
    for (const std::string& text : arguments.subject_to) {
        if (auto constraint = studies::parse_constraint(text)) {
            goal.constraints.push_back(*std::move(constraint));
        } else {
            faults.add("subject_to: " + constraint.error());
        }
    }
    return goal;
}

/// Adds the faults that show once the axes are known.
void check_search(const studies::SearchRequest& request, ArgumentFaults& faults) {
    if (const auto fault =
            studies::evaluations_fault(request.evaluations, studies::SearchSpace(request.axes))) {
        faults.add("evaluations: " + *fault);
    }
    if (request.goal.measure.empty()) {
        return;  // goal_of() has said so
    }
    for (const studies::SearchFault& fault : studies::measure_faults(request.goal, request.options.columns)) {
        std::string argument(fault.subject);
        std::ranges::replace(argument, '-', '_');
        faults.add(argument + ": " + fault.text);
    }
}

/// The outcome of a search, in C++.
struct Found {
    StudyRows rows;
    Json summary;
    measures::Warnings warnings;
};

Found found_by(const studies::SearchJob& job, const studies::Journal& journal) {
    Found found{rows_of(studies::table_of(job.study(), std::span(&journal, 1))),
                measures::summary_json(studies::search_summary(job, nullptr)), studies::search_warnings(job)};
    found.summary.erase("file");
    if (job.result().best.centre == studies::Evaluations::none) {
        found.warnings.push_back(studies::no_feasible_text(job));
    }
    return found;
}

/// (table as of python_table, summary, warnings)
py::tuple optimise(const SceneObject& scene, const KeysAndValues& vary, const SearchArguments& arguments,
                   const StudyArguments& study) {
    ArgumentFaults faults;
    const int jobs = jobs_of(study, faults);
    studies::SearchRequest request{scene.scene(),  {}, goal_of(arguments, faults), arguments.evaluations,
                                   arguments.seed, {}};
    std::optional<Plan> sample;  // points all over the ranges, to estimate the memory
    studies::PlanSummary summary;
    interruptible([&, keys = varied_keys(vary)](const std::atomic<bool>&) {
        sample = plan_of_axes(scene.scene(), keys,
                              std::clamp<std::int64_t>(request.evaluations, 1, studies::most_evaluations));
        if (*sample) {
            summary = studies::summary_of(**sample, measures::measurable_among(study.measure));
        }
    });
    if (!*sample) {
        faults.add(fault_text(std::move(*sample).error()));
        faults.refuse();
    }
    request.axes = (*sample)->axes();
    request.options = options_of(study, summary, faults);
    check_search(request, faults);
    faults.refuse();
    const studies::Study rows = study_of(request);
    require_memory_of_study("the search", static_cast<double>(request.evaluations), rows, jobs, summary);
    studies::Journal journal = studies::Journal::in_memory();
    std::optional<studies::SearchJob> job;
    Found found;
    interruptible([&](const std::atomic<bool>& stop) {
        journal.begin(studies::journal_text(rows), studies::columns_of(rows));
        journal.load(studies::columns_of(rows), rows.samples(), request.evaluations);
        job.emplace(request, journal, jobs, stop, [](std::int64_t) {});
        job->run();
        if (!stop) {
            found = found_by(*job, journal);
        }
    });
    return py::make_tuple(python_table(job->study(), found.rows), python_object(found.summary),
                          found.warnings);
}

}  // namespace

void add_studies(py::module_& module) {
    module.def(
        "sweep",
        [](const SceneObject& scene, const std::optional<KeysAndValues>& vary,
           const std::optional<KeysAndValues>& points, std::optional<std::int64_t> sobol,
           std::vector<std::string> measure, std::vector<std::string> quantities,
           std::optional<double> band_from_hz, std::optional<std::string> waveforms,
           std::optional<int> jobs) {
            const StudyArguments arguments{std::move(measure), std::move(quantities), band_from_hz,
                                           std::move(waveforms), jobs};
            if (points) {
                return sweep([&, keys = varied_keys(*points)] { return plan_of_points(scene.scene(), keys); },
                             arguments);
            }
            return sweep(
                [&, keys = varied_keys(vary.value_or(KeysAndValues{}))] {
                    return plan_of_axes(scene.scene(), keys, sobol);
                },
                arguments);
        },
        py::arg("scene"), py::arg("vary"), py::arg("points"), py::arg("sobol"), py::arg("measure"),
        py::arg("quantities"), py::arg("band_from_hz"), py::arg("waveforms"), py::arg("jobs"));
    module.def(
        "optimise",
        [](const SceneObject& scene, const KeysAndValues& vary, std::string maximise, std::string minimise,
           std::vector<std::string> subject_to, std::int64_t evaluations, std::uint64_t seed,
           std::vector<std::string> measure, std::optional<double> band_from_hz, std::optional<int> jobs) {
            return optimise(
                scene, vary,
                {std::move(maximise), std::move(minimise), std::move(subject_to), evaluations, seed},
                {std::move(measure), {}, band_from_hz, std::nullopt, jobs});
        },
        py::arg("scene"), py::arg("vary"), py::arg("maximise"), py::arg("minimise"), py::arg("subject_to"),
        py::arg("evaluations"), py::arg("seed"), py::arg("measure"), py::arg("band_from_hz"),
        py::arg("jobs"));
}

}  // namespace hertzline::python
