#include "hertzline/studies.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "apps/python/native/scene_object.hpp"

namespace hertzline::python {

namespace {

/// Values of a key as Python gives them: a range as text, contiguous numbers or integers, or words.
using Values =
    std::variant<std::string, py::array_t<double>, py::array_t<std::int64_t>, std::vector<std::string>>;
using KeysAndValues = std::vector<std::pair<std::string, Values>>;

StudyValues study_values(const std::string& range) {
    return range;
}

StudyValues study_values(const std::vector<std::string>& words) {
    return words;
}

template <class Number>
StudyValues study_values(const py::array_t<Number>& numbers) {
    return std::vector<Number>(numbers.data(), numbers.data() + numbers.size());
}

StudyKeys study_keys(const KeysAndValues& keys) {
    StudyKeys varied;
    for (const auto& [key, values] : keys) {
        varied.emplace_back(key, std::visit([](const auto& list) { return study_values(list); }, values));
    }
    return varied;
}

/// ([(name, unit, values)], waveforms or None, provenance)
py::tuple python_table(StudyTable&& table) {
    py::list columns;
    std::size_t points = 0;
    for (StudyColumn& column : table.columns) {
        py::object values;
        if (auto* integers = std::get_if<std::vector<std::int64_t>>(&column.values)) {
            points = integers->size();
            values = array_of(std::move(*integers));
        } else if (auto* numbers = std::get_if<std::vector<double>>(&column.values)) {
            values = array_of(std::move(*numbers));
        } else {
            values = py::cast(std::get<std::vector<std::string>>(column.values));
        }
        columns.append(py::make_tuple(column.name, column.unit, values));
    }
    py::object waveforms = py::none();
    if (table.waveform_samples > 0) {
        std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(points),
                                       static_cast<py::ssize_t>(table.waveform_samples)};
        if (table.waveform_channels > 1) {
            shape.push_back(static_cast<py::ssize_t>(table.waveform_channels));
        }
        waveforms = array_of(std::move(table.waveforms), std::move(shape));
    }
    return py::make_tuple(columns, waveforms, python_object(table.provenance));
}

/// Runs a study without the GIL; Ctrl-C ends it. @param study is given the options with its flag to stop
template <class Result>
Result run_study(StudyOptions options, const std::function<Result(const StudyOptions&)>& study) {
    std::optional<Result> result;
    with_os_errors([&] {
        interruptible([&](const std::atomic<bool>& stop) {
            options.stop = &stop;
            result = study(options);
        });
    });
    return *std::move(result);
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
            const StudyKeys keys = study_keys(points ? *points : vary.value_or(KeysAndValues{}));
            const SweepPoints kind = points ? SweepPoints::list : SweepPoints::grid;
            return python_table(run_study<StudyTable>(
                {std::move(measure), std::move(quantities), band_from_hz, std::move(waveforms), jobs},
                [&](const StudyOptions& options) {
                    return sweep(scene.scene(), keys, options, kind, sobol);
                }));
        },
        py::arg("scene"), py::arg("vary"), py::arg("points"), py::arg("sobol"), py::arg("measure"),
        py::arg("quantities"), py::arg("band_from_hz"), py::arg("waveforms"), py::arg("jobs"));
    module.def(
        "optimise",
        [](const SceneObject& scene, const KeysAndValues& vary, std::string maximise, std::string minimise,
           std::vector<std::string> subject_to, std::int64_t evaluations, std::uint64_t seed,
           std::vector<std::string> measure, std::optional<double> band_from_hz, std::optional<int> jobs) {
            const StudyKeys keys = study_keys(vary);
            const SearchGoal goal{std::move(maximise), std::move(minimise), std::move(subject_to),
                                  evaluations, seed};
            auto found = run_study<SearchOutcome>(
                {std::move(measure), {}, band_from_hz, std::nullopt, jobs},
                [&](const StudyOptions& options) { return optimise(scene.scene(), keys, goal, options); });
            return py::make_tuple(python_table(std::move(found.evaluations)), python_object(found.summary),
                                  found.warnings);
        },
        py::arg("scene"), py::arg("vary"), py::arg("maximise"), py::arg("minimise"), py::arg("subject_to"),
        py::arg("evaluations"), py::arg("seed"), py::arg("measure"), py::arg("band_from_hz"),
        py::arg("jobs"));
}

}  // namespace hertzline::python
