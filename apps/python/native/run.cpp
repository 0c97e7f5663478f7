#include "apps/python/native/run.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "measures/provenance.hpp"
#include "measures/run_record.hpp"
#include "measures/run_summary.hpp"
#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/python_values.hpp"
#include "apps/python/native/save.hpp"
#include "apps/python/native/scene_object.hpp"
#include "core/scene/text.hpp"
#include "core/simulation.hpp"

namespace hertzline::python {

namespace {

using Clock = std::chrono::steady_clock;

/// What the caller asks for, checked.
struct RunRequest {
    TapSet taps;      ///< to be kept
    TapSet measured;  ///< beside v_out
    std::optional<double> band_from_hz;
};

RunRequest checked(const Scene& scene, const std::optional<std::vector<std::string>>& taps,
                   const std::vector<std::string>& measure, std::optional<double> band_from_hz) {
    ArgumentFaults faults;
    const TapSet there = taps_of(scene.end);
    RunRequest request{taps ? taps_named("taps", *taps, there, faults) : recorded_taps(scene.end),
                       taps_named("measure", measure, there & measures::measurable_taps, faults),
                       band_from_hz};
    request.measured |= there & measures::measured_unasked;
    if (band_from_hz && !(*band_from_hz >= 0 && std::isfinite(*band_from_hz))) {
        faults.add("band_from_hz: found " + number_text(*band_from_hz) +
                   ", allowed: a finite number from 0 [Hz]");
    }
    if (const double rows = measures::rows_of_run(scene); rows > measures::max_run_rows) {
        faults.add("output.duration_s: found " + number_text(rows) + " samples, allowed: at most " +
                   number_text(measures::max_run_rows) + ", the longest record of a spectrum");
    }
    faults.refuse();
    return request;
}

/// Bytes of the samples, the simulation and the spectra, roughly from above.
double memory_of(const Scene& scene, const RunRequest& request) {
    const double rows = measures::rows_of_run(scene);
    const TapSet taps = measures::taps_of_run(scene, request.taps | request.measured);
    const double numbers = channels_of(taps, static_cast<double>(scene.chain.spheres)) + 2;
    return Simulation::memory_bytes(scene, taps) + sizeof(double) * rows * numbers +
           measures::SpectrumAnalyser::bytes_needed(rows);
}

/// Simulates, and makes the summary as `hertzline run` does. Needs no GIL.
/// @throws std::runtime_error when the integration fails
void simulate(const Resolution& resolved, const RunRequest& request, const std::atomic<bool>& stop,
              RunResult& result) {
    const Clock::time_point start = Clock::now();
    const Scene& scene = resolved.scene;
    const TapSet taps = measures::taps_of_run(scene, request.taps | request.measured);
    Simulation simulation(scene, {.taps = taps, .stop = &stop});
    const auto rows = static_cast<std::size_t>(measures::rows_of_run(scene));
    measures::RunRecord record = measures::empty_record(request.measured, simulation.chain().end, rows);
    TapSet beside = request.taps;  // what the record does not keep
    for (const measures::TapRecord& tap : record.taps) {
        beside = beside - tap.tap;
    }
    for (const Tap tap : beside) {
        result.column(tap).reserve(rows * channels_of(tap, result.spheres));
    }
    const double setup_s = std::chrono::duration<double>(Clock::now() - start).count();
    const Status status = measures::simulate(simulation, record, [&](const Samples& block) {
        for (const Tap tap : beside) {
            result.column(tap).insert(result.column(tap).end(), block[tap].begin(), block[tap].end());
        }
        return true;
    });
    if (status == Status::stopped) {
        return;
    }
    if (status != Status::running) {
        throw std::runtime_error(simulation.failure());
    }
    measures::SpectrumAnalyser analyser(rows, scene.output.sample_rate_hz);
    result.warnings = measures::scene_warnings(resolved);
    std::vector<measures::SummaryGroup> groups =
        measures::measures_of_run(record, scene, analyser, request.band_from_hz, result.warnings);
    groups.push_back(measures::contacts_of_run(record, scene, result.warnings));
    groups.push_back(measures::trust_of_run(record, resolved));
    groups.push_back(measures::account_of_run(record, scene));
    measures::add_times(groups.back(), setup_s, record.wall_s());
    measures::add_identity(groups.back(), scene);
    result.summary = measures::summary_json(groups);
    for (measures::TapRecord& tap : record.taps) {
        result.column(tap.tap) = std::move(tap.values);
    }
    result.held = beside | request.measured | Tap::v_out;
}

std::shared_ptr<RunResult> run(SceneObject& object, const std::optional<std::vector<std::string>>& taps,
                               const std::vector<std::string>& measure, std::optional<double> band_from_hz) {
    const RunRequest request = checked(object.scene(), taps, measure, band_from_hz);
    const std::shared_ptr<const Resolution> resolved = object.resolved();
    require_memory("simulating " + object.origin(), memory_of(resolved->scene, request));
    auto result = std::make_shared<RunResult>();
    result->sample_rate_hz = resolved->scene.output.sample_rate_hz;
    result->rows = static_cast<std::size_t>(measures::rows_of_run(resolved->scene));
    result->spheres = static_cast<std::size_t>(resolved->scene.chain.spheres);
    result->asked = request.taps;
    result->provenance =
        measures::provenance_json({resolved->scene, resolved->estimate,
                                   measures::utc_text(std::chrono::system_clock::now()), std::nullopt});
    interruptible([&](const std::atomic<bool>& stop) { simulate(*resolved, request, stop, *result); });
    return result;
}

Tap held_tap(const RunResult& result, const std::string& name) {
    const auto tap = measures::find_tap(name, result.held);
    if (!tap) {
        throw py::key_error(tap.error());
    }
    return *tap;
}

/// [sample], or [sample][sphere] or [sample][contact] of a tap of the whole chain.
py::array_t<double> samples_of_tap(const std::shared_ptr<RunResult>& result, const std::string& name) {
    const Tap tap = held_tap(*result, name);
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(result->rows)};
    if (chain_taps.contains(tap)) {
        shape.push_back(static_cast<py::ssize_t>(channels_of(tap, result->spheres)));
    }
    return view_of(result->column(tap).data(), shape, py::cast(result));
}

}  // namespace

void add_run(py::module_& module) {
    py::class_<RunResult, std::shared_ptr<RunResult>>(module, "Run")
        .def_readonly("sample_rate_hz", &RunResult::sample_rate_hz)
        .def_readonly("rows", &RunResult::rows)
        .def_readonly("warnings", &RunResult::warnings)
        .def_property_readonly("taps",
                               [](const RunResult& result) { return measures::names_of(result.held); })
        .def_property_readonly("asked",
                               [](const RunResult& result) { return measures::names_of(result.asked); })
        .def("summary", [](const RunResult& result) { return python_object(result.summary); })
        .def("provenance", [](const RunResult& result) { return python_object(result.provenance); })
        .def("samples", &samples_of_tap, py::arg("tap"))
        .def(
            "unit",
            [](const RunResult& result, const std::string& name) {
                return std::string(row_of(held_tap(result, name)).unit);
            },
            py::arg("tap"))
        .def("save", &save, py::arg("paths"), py::arg("taps"), py::arg("wav_scale"));
    module.def("run", &run, py::arg("scene"), py::arg("taps"), py::arg("measure"), py::arg("band_from_hz"));
}

}  // namespace hertzline::python
