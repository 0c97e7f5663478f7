#include "hertzline/spectrum.hpp"

#include <optional>
#include <span>
#include <utility>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "core/scene/faults.hpp"
#include "measures/measuring.hpp"
#include "measures/quantities.hpp"

namespace hertzline::python {

namespace {

using Record = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Returns frequencies [Hz], amplitudes [as the samples], and the numbers of docs/measures.md, which are None without a
/// fundamental.
py::tuple spectrum(const Record& samples, double sample_rate_hz, std::optional<double> fundamental_hz,
                   std::optional<double> band_from_hz) {
    Faults faults;
    if (samples.ndim() != 1) {
        faults.add("spectrum: found samples of several channels, allowed: one, as \"v3_m_per_s\" of v_chain");
    }
    faults.add("band_from_hz", measures::band_from_fault(band_from_hz));
    faults.refuse<py::value_error>();
    const std::span<const double> record(samples.data(), static_cast<std::size_t>(samples.size()));
    require_memory("a spectrum", SpectrumAnalyser::bytes_needed(static_cast<double>(record.size())));
    MagnitudeSpectrum lines;
    std::optional<SpectrumSummary> summary;
    interruptible([&](const std::atomic<bool>&) {
        SpectrumAnalyser analyser(record.size(), sample_rate_hz);
        lines = analyser.magnitudes(record);
        if (fundamental_hz) {
            summary = analyser.analyse(record, *fundamental_hz, band_from_hz);
        }
    });
    return py::make_tuple(array_of(std::move(lines.frequencies_hz)), array_of(std::move(lines.amplitudes)),
                          summary ? python_object(measures::spectrum_json(*summary)) : py::none());
}

}  // namespace

void add_spectrum(py::module_& module) {
    module.def("spectrum", &spectrum, py::arg("samples"), py::arg("sample_rate_hz"),
               py::arg("fundamental_hz"), py::arg("band_from_hz"));
}

}  // namespace hertzline::python
