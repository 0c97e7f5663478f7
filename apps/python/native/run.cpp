#include "measures/run.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "apps/python/native/save.hpp"
#include "apps/python/native/scene_object.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "measures/measuring.hpp"
#include "measures/provenance.hpp"
#include "measures/quantities.hpp"
#include "measures/tap_names.hpp"
#include "recordings/columns.hpp"

namespace hertzline::python {

namespace {

/// The checked arguments of run().
struct RunRequest {
    TapSet taps;      ///< to be kept
    TapSet measured;  ///< beside v_out
    std::optional<double> band_from_hz;
};

RunRequest checked(const Scene& scene, const std::optional<std::vector<std::string>>& taps,
                   const std::vector<std::string>& measure, std::optional<double> band_from_hz) {
    Faults faults;
    const TapSet there = taps_of(scene);
    RunRequest request{taps ? measures::taps_named("taps", *taps, there, faults) : recorded_taps(scene),
                       measures::taps_named("measure", measure, there & measures::measurable_taps, faults),
                       band_from_hz};
    request.measured = measures::measured_taps(scene, request.measured);
    faults.add("band_from_hz", measures::band_from_fault(band_from_hz));
    faults.add(measures::longest_run_fault(scene));
    faults.refuse<py::value_error>();
    return request;
}

/// Returns the bytes of a run and of the samples that it keeps, roughly from above.
double memory_of(const Scene& scene, const RunRequest& request) {
    const TapSet wanted = request.taps | request.measured;
    return measures::memory_of_run(scene, measures::taps_of_run(scene, wanted), request.measured) +
           sizeof(double) * measures::rows_of_run(scene) *
               channels_of(wanted | Tap::v_out, channel_counts(scene));
}

/// Runs the scene and takes over its samples and numbers. Needs no GIL. @param setup_s that the choice of its step took
/// @throws std::runtime_error when the integration fails
void simulate(const Resolution& resolved, const RunRequest& request, double setup_s,
              const std::atomic<bool>& stop, RunResult& result) {
    const TapSet measured = request.measured | Tap::v_out;
    // taps that a Run does not keep, or of an array's middle element only
    const TapSet beside = result.counts.elements > 1 ? request.taps | measured : request.taps - measured;
    for (const Tap tap : beside) {
        result.column(tap).reserve(result.rows * channels_of(tap, result.counts));
    }
    hertzline::Run run =
        hertzline::run(resolved, {.recorded = beside,
                                  .measured = request.measured,
                                  .band_from_hz = request.band_from_hz,
                                  .stop = &stop,
                                  .take = [&](const Samples& block) {
                                      for (const Tap tap : beside) {
                                          result.column(tap).insert(result.column(tap).end(),
                                                                    block[tap].begin(), block[tap].end());
                                      }
                                      return true;
                                  }});
    if (run.stopped) {
        return;
    }
    run.setup_s += setup_s;
    result.warnings = measures::all_warnings(run);
    result.summary = measures::summary_json(measures::summary_of(run));
    for (TapRecord& tap : run.taps) {
        if (!beside.contains(tap.tap)) {
            result.column(tap.tap) = std::move(tap.values);
        }
    }
    result.held = beside | measured;
}

std::shared_ptr<RunResult> run(SceneObject& object, const std::optional<std::vector<std::string>>& taps,
                               const std::vector<std::string>& measure, std::optional<double> band_from_hz) {
    const RunRequest request = checked(object.scene(), taps, measure, band_from_hz);
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<const Resolution> resolved = object.resolved_to_run();
    const double setup_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    require_memory("simulating " + printable_whole(object.origin()), memory_of(resolved->scene, request));
    auto result = std::make_shared<RunResult>();
    result->sample_rate_hz = resolved->scene.output.sample_rate_hz;
    result->rows = static_cast<std::size_t>(measures::rows_of_run(resolved->scene));
    result->counts = channel_counts(resolved->scene);
    result->asked = request.taps;
    result->provenance = measures::provenance_json(*resolved);
    interruptible(
        [&](const std::atomic<bool>& stop) { simulate(*resolved, request, setup_s, stop, *result); });
    return result;
}

/// A tap that is held, or one channel of it.
struct Selection {
    Tap tap;
    std::optional<std::size_t> channel;
};

/// @param name of a tap, or of a column that a recording has: "v3_m_per_s" of "v_chain" @throws py::key_error for another
Selection selection_of(const RunResult& result, const std::string& name) {
    const auto named = measures::find_tap(name, result.held);
    if (named) {
        return {*named, std::nullopt};
    }
    for (const Tap tap : result.held) {
        const auto columns = recordings::recorded_columns(tap, result.counts);
        const auto column = std::ranges::find(columns, name, &recordings::Column::name);
        if (column != columns.end()) {
            return {tap, static_cast<std::size_t>(column - columns.begin())};
        }
    }
    throw py::key_error(named.error());
}

/// Returns [sample], or [sample][sphere] or [sample][contact] of a tap of the whole chain.
py::array_t<double> samples_of_run(const std::shared_ptr<RunResult>& result, const std::string& name) {
    const auto [tap, channel] = selection_of(*result, name);
    const std::vector<double>& samples = result->column(tap);
    const auto channels = static_cast<py::ssize_t>(channels_of(tap, result->counts));
    const auto rows = static_cast<py::ssize_t>(result->rows);
    if (std::ssize(samples) != rows * channels) {
        throw std::logic_error(name + " is not complete");
    }
    if (channel) {
        return view_of(samples.data() + *channel, {rows}, py::cast(result), {channels});
    }
    return has_channels(tap, result->counts) ? view_of(samples.data(), {rows, channels}, py::cast(result))
                                             : view_of(samples.data(), {rows}, py::cast(result));
}

/// Returns all of a run for pickle; JSON as text, which keeps every number.
py::tuple state_of_run(const std::shared_ptr<RunResult>& result) {
    py::dict samples;
    for (const Tap tap : result->held) {
        samples[py::str(std::string(row_of(tap).name))] =
            samples_of_run(result, std::string(row_of(tap).name));
    }
    return py::make_tuple(result->sample_rate_hz, result->rows, result->counts.spheres, result->counts.points,
                          result->counts.elements, measures::names_of(result->asked), samples,
                          json_text(result->summary), json_text(result->provenance), result->warnings);
}

std::shared_ptr<RunResult> restored_run(const py::tuple& state) {
    auto result = std::make_shared<RunResult>();
    result->sample_rate_hz = state[0].cast<double>();
    result->rows = state[1].cast<std::size_t>();
    result->counts = {.spheres = state[2].cast<std::size_t>(),
                      .points = state[3].cast<std::size_t>(),
                      .elements = state[4].cast<std::size_t>()};
    for (const auto& name : state[5].cast<std::vector<std::string>>()) {
        result->asked |= tap_named(name).value();
    }
    for (const auto& [name, samples] : state[6].cast<py::dict>()) {
        const Tap tap = tap_named(name.cast<std::string>()).value();
        const auto values = samples.cast<py::array_t<double, py::array::c_style | py::array::forcecast>>();
        result->held |= tap;
        result->column(tap).assign(values.data(), values.data() + values.size());
    }
    result->summary = json_from_outside(state[7].cast<std::string>());
    result->provenance = json_from_outside(state[8].cast<std::string>());
    result->warnings = state[9].cast<std::vector<std::string>>();
    return result;
}

}  // namespace

void add_run(py::module_& module) {
    py::class_<RunResult, std::shared_ptr<RunResult>>(module, "Run")
        .def_readonly("sample_rate_hz", &RunResult::sample_rate_hz)
        .def_readonly("rows", &RunResult::rows)
        .def_readonly("warnings", &RunResult::warnings)
        .def_property_readonly("taps",
                               [](const RunResult& result) { return measures::names_of(result.held); })
        .def("summary", [](const RunResult& result) { return python_object(result.summary); })
        .def("provenance", [](const RunResult& result) { return python_object(result.provenance); })
        .def("samples", &samples_of_run, py::arg("name"))
        .def(
            "unit",
            [](const RunResult& result, const std::string& name) {
                return std::string(row_of(selection_of(result, name).tap).unit);
            },
            py::arg("name"))
        .def("__reduce_ex__", &reduced)
        .def(py::pickle(&state_of_run, &restored_run))
        .def("save", &save, py::arg("paths"), py::arg("taps"), py::arg("wav_scale"));
    module.def("run", &run, py::arg("scene"), py::arg("taps"), py::arg("measure"), py::arg("band_from_hz"));
}

}  // namespace hertzline::python
