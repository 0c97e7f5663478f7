#include "apps/python/native/sweep.hpp"

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
#include "studies/sweep/survey.hpp"
#include "studies/sweep/sweep.hpp"
#include "studies/sweep/sweep_table.hpp"
#include "studies/sweep/workers.hpp"
#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/python_values.hpp"
#include "apps/python/native/scene_object.hpp"
#include "core/scene/text.hpp"

namespace hertzline::python {

namespace {

constexpr int max_jobs = 1024;

/// As Python gives it.
struct SweepRequest {
    studies::PlanRequest plan;
    std::vector<std::string> measure;
    std::vector<std::string> quantities;
    std::optional<double> band_from_hz;
    std::optional<std::string> waveforms;
    std::optional<int> jobs;
};

/// A column of the table, from the first point to the last.
using TableColumn = std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>>;

struct Rows {
    std::vector<TableColumn> columns;
    std::vector<float> waveforms;  ///< row-major, [point][sample]
};

int jobs_of(const SweepRequest& request, ArgumentFaults& faults) {
    const int jobs = request.jobs.value_or(std::min(measures::usable_processors(), max_jobs));
    if (jobs < 1 || jobs > max_jobs) {
        faults.add("jobs: found " + number_text(std::int64_t{jobs}) + ", allowed: 1 to " +
                   number_text(std::int64_t{max_jobs}));
    }
    return jobs;
}

/// What is kept of each point. What is wrong goes to the faults.
studies::PointDemand demand_of(const SweepRequest& request, const studies::SweepSurvey& survey,
                               ArgumentFaults& faults) {
    const TapSet there = survey.measurable();
    studies::PointDemand demand;
    demand.measured = taps_named("measure", request.measure, there, faults);
    demand.band_from_hz = request.band_from_hz;
    if (const auto fault = measures::band_from_fault(demand.band_from_hz)) {
        faults.add("band_from_hz: " + *fault);
    }
    if (request.waveforms) {
        const TapSet tap = taps_named("waveforms", {*request.waveforms}, there, faults);
        demand.waveform = tap.empty() ? std::nullopt : std::optional<Tap>(*tap.begin());
        demand.waveform_samples = static_cast<std::size_t>(survey.rows);
    }
    auto columns = measures::chosen_columns(
        measures::number_columns((demand.measured | measures::measured_unasked) & there, survey.modal),
        request.quantities);
    if (columns) {
        demand.columns = *std::move(columns);
    } else {
        for (const std::string& fault : columns.error()) {
            faults.add("quantities: " + fault);
        }
    }
    return demand;
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

Rows rows_of(const recordings::Table& table) {
    Rows rows{empty_columns(table), {}};
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

/// Runs all points. @returns nothing when it was stopped
std::optional<Rows> run(const studies::Sweep& sweep, int jobs, const std::atomic<bool>& stop) {
    studies::Journal journal = studies::Journal::in_memory();
    journal.begin(studies::journal_text(sweep), studies::columns_of(sweep));
    studies::load_rows(journal, sweep);
    std::vector<std::int64_t> points(static_cast<std::size_t>(sweep.plan.size()));
    std::iota(points.begin(), points.end(), std::int64_t{0});
    studies::run_points(sweep, journal, points, jobs, stop, [](const studies::PointCounts&) {});
    if (stop) {
        return std::nullopt;
    }
    return rows_of(studies::table_of(sweep, std::span(&journal, 1)));
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

/// [(name, unit, values)], waveforms or None, and where it all comes from.
py::tuple python_table(const studies::Sweep& sweep, Rows& rows) {
    const std::vector<recordings::TableColumn> about = studies::columns_of(sweep);
    py::list columns;
    for (std::size_t i = 0; i < rows.columns.size(); ++i) {
        columns.append(
            py::make_tuple(about[i].about.name, about[i].about.unit, python_column(rows.columns[i])));
    }
    py::object waveforms = py::none();
    if (sweep.demand.waveform) {
        waveforms =
            array_of(std::move(rows.waveforms), {static_cast<py::ssize_t>(sweep.plan.size()),
                                                 static_cast<py::ssize_t>(sweep.demand.waveform_samples)});
    }
    return py::make_tuple(columns, waveforms, python_object(studies::sweep_provenance(sweep)));
}

py::tuple sweep(const SceneObject& scene, const SweepRequest& request) {
    ArgumentFaults faults;
    const int jobs = jobs_of(request, faults);
    auto plan = studies::SweepPlan::make(scene.scene(), request.plan);
    if (!plan) {
        faults.add(fault_text(std::move(plan.error())));
        faults.refuse();
    }
    studies::SweepSurvey survey;
    interruptible([&](const std::atomic<bool>&) {
        survey = studies::survey_of(*plan, measures::measurable_among(request.measure));
    });
    studies::PointDemand demand = demand_of(request, survey, faults);
    faults.refuse();
    const auto points = static_cast<double>(plan->size());
    const studies::Sweep wanted{*std::move(plan), std::move(demand), {}};
    const double kept = studies::Journal::bytes(points, studies::columns_of(wanted), wanted.samples());
    require_memory("the sweep", jobs * survey.memory_bytes + 2 * kept);
    std::optional<Rows> rows;
    with_os_errors(
        [&] { interruptible([&](const std::atomic<bool>& stop) { rows = run(wanted, jobs, stop); }); });
    return python_table(wanted, *rows);
}

}  // namespace

void add_sweep(py::module_& module) {
    module.def(
        "sweep",
        [](const SceneObject& scene, std::vector<std::string> vary, std::string points,
           std::optional<std::int64_t> sobol, std::vector<std::string> measure,
           std::vector<std::string> quantities, std::optional<double> band_from_hz,
           std::optional<std::string> waveforms, std::optional<int> jobs) {
            return sweep(scene, {{std::move(vary), std::move(points), "points", sobol},
                                 std::move(measure),
                                 std::move(quantities),
                                 band_from_hz,
                                 std::move(waveforms),
                                 jobs});
        },
        py::arg("scene"), py::arg("vary"), py::arg("points"), py::arg("sobol"), py::arg("measure"),
        py::arg("quantities"), py::arg("band_from_hz"), py::arg("waveforms"), py::arg("jobs"));
}

}  // namespace hertzline::python
