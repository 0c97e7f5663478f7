#include "hertzline/studies.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "measures/resources.hpp"
#include "measures/tap_names.hpp"
#include "studies/search_job.hpp"
#include "studies/search_report.hpp"
#include "studies/study.hpp"
#include "studies/workers.hpp"

namespace hertzline {

namespace {

using Axes = tl::expected<std::vector<studies::Axis>, std::vector<Fault>>;
using Plan = tl::expected<studies::SweepPlan, std::vector<Fault>>;

/// Whether the values are a range. A key whose values are texts, as names of files, has none.
bool is_range(const Scene& scene, const std::string& key, const StudyValues& values) {
    const auto* text = std::get_if<std::string>(&values);
    const auto known = scene_key_named(scene, key);
    return text != nullptr && text->find("..") != std::string::npos && !(known && known->traits.is_text);
}

/// Returns the values of a list; those of a text stand between its commas.
std::vector<SceneValue> list_of(const StudyValues& values) {
    return std::visit(
        [](const auto& list) {
            if constexpr (std::is_same_v<std::decay_t<decltype(list)>, std::string>) {
                std::vector<SceneValue> words;
                for (const std::string_view word : split(list, ',')) {
                    words.emplace_back(std::string(trimmed(word, " ")));
                }
                return words;
            } else {
                return std::vector<SceneValue>(list.begin(), list.end());
            }
        },
        values);
}

/// The faults of a key that is not known, and of an empty list.
std::vector<Fault> key_faults(const Scene& scene, const StudyKeys::value_type& varied) {
    const auto& [key, values] = varied;
    if (const auto known = scene_key_named(scene, key); !known) {
        return {known.error()};
    }
    if (!std::holds_alternative<std::string>(values) && list_of(values).empty()) {
        return {{key, "no values", "at least one"}};
    }
    return {};
}

/// The axes, or every fault. @param keys without key_faults()
Axes axes_of(const Scene& scene, const StudyKeys& keys, studies::Sampling sampling) {
    std::vector<studies::Axis> axes;
    std::vector<Fault> faults;
    for (const auto& [key, values] : keys) {
        const auto* range = std::get_if<std::string>(&values);
        auto axis = range != nullptr ? studies::parse_axis(scene, key + '=' + *range, sampling)
                                     : studies::axis_of(scene, key, list_of(values));
        if (axis) {
            axes.push_back(*std::move(axis));
        } else {
            std::ranges::move(axis.error(), std::back_inserter(faults));
        }
    }
    return faults.empty() ? Axes(std::move(axes)) : tl::unexpected(std::move(faults));
}

Plan plan_of_axes(const Scene& scene, const StudyKeys& keys, std::optional<std::int64_t> sobol) {
    auto axes = axes_of(scene, keys, sobol ? studies::Sampling::anywhere : studies::Sampling::grid);
    return axes ? studies::SweepPlan::make(scene, *std::move(axes), sobol)
                : tl::unexpected(std::move(axes).error());
}

Plan plan_of_list(const Scene& scene, const StudyKeys& keys) {
    std::vector<studies::PointColumn> columns;
    std::vector<Fault> faults;
    for (const auto& [key, values] : keys) {
        if (is_range(scene, key, values)) {
            faults.push_back({key, "a range", "a list with a value for each point"});
        }
        columns.push_back({key, list_of(values)});
        if (const std::size_t points = columns.front().values.size();
            columns.back().values.size() != points) {
            faults.push_back(
                {key, number_text(static_cast<std::int64_t>(columns.back().values.size())) + " values",
                 number_text(static_cast<std::int64_t>(points)) + ", as many as of " + keys.front().first});
        }
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    return studies::points_of(scene, columns).map([&](studies::PointList points) {
        return studies::SweepPlan::of_points(scene, std::move(points));
    });
}

/// The plan of the keys, or every fault. @param make makes the plan of keys without key_faults()
template <class Make>
Plan plan_of(const Scene& scene, const StudyKeys& keys, Make make) {
    std::vector<Fault> faults;
    StudyKeys known;
    for (const auto& key : keys) {
        const std::vector<Fault> found = key_faults(scene, key);
        std::ranges::copy(found, std::back_inserter(faults));
        if (found.empty()) {
            known.push_back(key);
        }
    }
    if (keys.empty()) {
        faults.push_back({"", "no keys that vary", "at least one"});
    }
    Plan plan = known.empty() ? Plan(tl::unexpected(std::vector<Fault>())) : make(known);
    if (faults.empty()) {
        return plan;
    }
    if (!plan) {
        std::ranges::copy(plan.error(), std::back_inserter(faults));
    }
    return tl::unexpected(std::move(faults));
}

/// Returns the plan. Its faults have no place: axes name an option of the program. @throws std::invalid_argument with every fault
studies::SweepPlan required(Plan plan, const Faults& others) {
    if (!plan) {
        for (Fault& fault : plan.error()) {
            fault.place = {};
        }
        Faults faults = others;
        faults.add({}, plan.error());
        faults.refuse<std::invalid_argument>();
    }
    return *std::move(plan);
}

int jobs_of(const StudyOptions& options, Faults& faults) {
    const int jobs = options.jobs.value_or(studies::usual_jobs());
    faults.add("jobs", studies::jobs_fault(jobs));
    return jobs;
}

/// The measurements at each point.
studies::PointOptions point_options(const StudyOptions& options, const studies::SweepPlan& plan,
                                    const studies::PlanSummary& summary, Faults& faults) {
    const TapSet there = summary.measurable();
    studies::PointOptions point;
    point.measured = measures::taps_named("measure", options.measure, there, faults);
    point.band_from_hz = options.band_from_hz;
    faults.add("band_from_hz", measures::band_from_fault(point.band_from_hz));
    if (options.waveforms) {
        studies::keep_waveforms(point, *options.waveforms, summary, "waveforms", faults);
    }
    const auto columns =
        measures::number_columns((point.measured | measures::measured_unasked) & there, summary.modal);
    point.frequency_given =
        plan.base().drive.frequency_hz != Drive{}.frequency_hz || studies::varies(plan, "drive.frequency_hz");
    point.columns = faults.value_of("quantities", measures::chosen_columns(columns, options.quantities))
                        .value_or(columns);
    return point;
}

StudyTable empty_table(const studies::Study& study) {
    StudyTable table;
    for (const recordings::TableColumn& column : studies::columns_of(study)) {
        table.columns.push_back({column.about.name, column.about.unit, {}});
        switch (column.kind) {
            case recordings::CellKind::integer:
                table.columns.back().values = std::vector<std::int64_t>();
                break;
            case recordings::CellKind::number:
                table.columns.back().values = std::vector<double>();
                break;
            case recordings::CellKind::text:
                table.columns.back().values = std::vector<std::string>();
                break;
        }
    }
    if (study.options.waveform) {
        table.waveform_samples = study.options.waveform_samples;
        table.waveform_channels = study.options.waveform_channels;
    }
    table.provenance = studies::provenance_of(study);
    return table;
}

/// @param journal has all rows
StudyTable table_of(const studies::Study& study, const studies::Journal& journal) {
    StudyTable table = empty_table(study);
    const recordings::Table rows = studies::table_of(study, std::span(&journal, 1));
    recordings::TableRow row;
    for (std::int64_t point = 0; point < rows.rows; ++point) {
        rows.read(point, row);
        for (std::size_t i = 0; i < row.cells.size(); ++i) {
            std::visit(
                [&](auto& cell) {
                    std::get<std::vector<std::decay_t<decltype(cell)>>>(table.columns[i].values)
                        .push_back(cell);
                },
                row.cells[i]);
        }
        table.waveforms.insert(table.waveforms.end(), row.samples.begin(), row.samples.end());
    }
    return table;
}

void require_memory(const char* purpose, double points, const studies::Study& study, int jobs,
                    const studies::PlanSummary& plan) {
    const double kept = studies::Journal::bytes(points, studies::columns_of(study), study.samples());
    throw_if<OutOfMemory>(measures::memory_shortage(purpose, jobs * plan.memory_bytes + 2 * kept));
}

studies::Goal goal_of(const SearchGoal& wanted, Faults& faults) {
    const bool maximise = !wanted.maximise.empty();
    if (maximise == !wanted.minimise.empty()) {
        faults.add(maximise ? "maximise and minimise: found both, allowed: one of them"
                            : "maximise or minimise is missing: give the name of a number");
    }
    studies::Goal goal{maximise ? wanted.maximise : wanted.minimise, maximise, {}};
    for (const std::string& text : wanted.subject_to) {
        if (auto constraint = faults.value_of("subject_to", studies::parse_constraint(text))) {
            goal.constraints.push_back(*std::move(constraint));
        }
    }
    return goal;
}

/// Adds the faults that show once the axes are known.
void check_search(const studies::SearchRequest& request, Faults& faults) {
    faults.add("evaluations",
               studies::evaluations_fault(request.evaluations, studies::SearchSpace(request.axes)));
    if (request.goal.measure.empty()) {
        return;  // goal_of() has reported it
    }
    for (const studies::SearchFault& fault : studies::measure_faults(request.goal, request.options.columns)) {
        std::string subject(fault.subject);
        std::ranges::replace(subject, '-', '_');
        faults.add(subject, fault.text);
    }
}

const std::atomic<bool> never = false;

const std::atomic<bool>& stop_of(const StudyOptions& options) noexcept {
    return options.stop != nullptr ? *options.stop : never;
}

}  // namespace

std::vector<double> StudyTable::operator[](std::string_view name) const {
    const auto column = std::ranges::find(columns, name, &StudyColumn::name);
    if (column != columns.end()) {
        if (const auto* numbers = std::get_if<std::vector<double>>(&column->values)) {
            return *numbers;
        }
        if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&column->values)) {
            return {integers->begin(), integers->end()};
        }
    }
    throw std::out_of_range("the table has no column of numbers " + quoted_briefly(name));
}

const std::vector<std::string>& StudyTable::words(std::string_view name) const {
    const auto column = std::ranges::find(columns, name, &StudyColumn::name);
    if (column == columns.end() || !std::holds_alternative<std::vector<std::string>>(column->values)) {
        throw std::out_of_range("the table has no column of words " + quoted_briefly(name));
    }
    return std::get<std::vector<std::string>>(column->values);
}

StudyTable sweep(const Scene& scene, const StudyKeys& vary, const StudyOptions& options, SweepPoints points,
                 std::optional<std::int64_t> sobol) {
    Faults faults;
    const int jobs = jobs_of(options, faults);
    if (points == SweepPoints::list && sobol) {
        faults.add("sobol: found together with a list of points, allowed: with ranges");
    }
    const auto make_plan = [&](const StudyKeys& keys) {
        return points == SweepPoints::list ? plan_of_list(scene, keys) : plan_of_axes(scene, keys, sobol);
    };
    studies::SweepPlan plan = required(plan_of(scene, vary, make_plan), faults);
    const studies::PlanSummary summary =
        studies::summary_of(plan, measures::measurable_among(options.measure), options.stop);
    studies::PointOptions point = point_options(options, plan, summary, faults);
    faults.refuse<std::invalid_argument>();
    const studies::Study study{std::move(plan), std::move(point), {}};
    require_memory("the sweep", static_cast<double>(study.plan.size()), study, jobs, summary);
    studies::Journal journal = studies::Journal::in_memory();
    journal.begin(studies::journal_text(study), studies::columns_of(study));
    studies::load_rows(journal, study);
    std::vector<std::int64_t> numbers(static_cast<std::size_t>(study.plan.size()));
    std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
    studies::run_points(study, journal, numbers, jobs, stop_of(options), [](const studies::PointCounts&) {});
    return stop_of(options) ? empty_table(study) : table_of(study, journal);
}

SearchOutcome optimise(const Scene& scene, const StudyKeys& vary, const SearchGoal& goal,
                       const StudyOptions& options) {
    Faults faults;
    const int jobs = jobs_of(options, faults);
    studies::SearchRequest request{scene, {}, goal_of(goal, faults), goal.evaluations, goal.seed, {}};
    // points all over the ranges show the memory of a search, and its taps
    const auto make_sample = [&](const StudyKeys& keys) {
        return plan_of_axes(scene, keys,
                            std::clamp<std::int64_t>(goal.evaluations, 1, studies::most_evaluations));
    };
    const studies::SweepPlan sample = required(plan_of(scene, vary, make_sample), faults);
    const studies::PlanSummary summary =
        studies::summary_of(sample, measures::measurable_among(options.measure), options.stop);
    request.axes = sample.axes();
    request.options = point_options(options, sample, summary, faults);
    check_search(request, faults);
    faults.refuse<std::invalid_argument>();
    const studies::Study rows = studies::study_of(request);
    require_memory("the search", static_cast<double>(request.evaluations), rows, jobs, summary);
    studies::Journal journal = studies::Journal::in_memory();
    journal.begin(studies::journal_text(rows), studies::columns_of(rows));
    journal.load(studies::columns_of(rows), rows.samples(), request.evaluations);
    studies::SearchJob job(request, journal, jobs, stop_of(options), [](std::int64_t) {});
    job.run();
    if (stop_of(options)) {
        return {empty_table(job.study()), nullptr, {}};
    }
    SearchOutcome outcome{table_of(job.study(), journal),
                          measures::summary_json(studies::search_summary(job, nullptr)),
                          studies::search_warnings(job)};
    outcome.summary.erase("file");
    if (job.result().best.centre == studies::Evaluations::none) {
        outcome.warnings.push_back(studies::no_feasible_text(job));
    }
    return outcome;
}

}  // namespace hertzline
