#include "apps/python/native/listen.hpp"

#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measures/run.hpp"
#include <pybind11/stl.h>

#include "apps/python/native/python_values.hpp"
#include "core/scene/text.hpp"
#include "core/taps.hpp"
#include "stream/listening/listener.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/security/certificate.hpp"

namespace hertzline::python {

std::optional<stream::CurveClient> keys_of(const std::optional<std::string>& own,
                                           const std::optional<std::string>& server, ArgumentFaults& faults) {
    if (!own && !server) {
        return std::nullopt;
    }
    if (!own || !server) {
        faults.add("curve_key: found " + std::string(own ? "no server_key" : "none beside server_key") +
                   ", allowed: both or neither");
        return std::nullopt;
    }
    const auto pair = stream::read_key_pair(*own);
    const auto key = stream::read_public_key(*server);
    if (!pair) {
        faults.add("curve_key: " + pair.error());
    }
    if (!key) {
        faults.add("server_key: " + key.error());
    }
    return pair && key ? std::optional(stream::CurveClient{*pair, *key}) : std::nullopt;
}

namespace {

constexpr auto nap = std::chrono::milliseconds(100);  // between looks at signals

/// A listener whose waiting lets other threads of Python run. For one thread at a time, but for close().
class PythonListener {
public:
    PythonListener(const std::string& endpoint, stream::ListenerOptions options)
        : listener_(endpoint, with_notices(std::move(options))) {}

    /// (samples, header's numbers, missing) of the next frame; None at the end. @throws py::error_already_set of a signal handler
    py::object next() {
        while (!listener_.ended()) {
            if (stream::ReceivedFrame* frame = frame_or_nothing()) {
                return block_of(*frame);
            }
            if (PyErr_CheckSignals() != 0) {
                throw py::error_already_set();
            }
        }
        return py::none();
    }

    void close() {
        const py::gil_scoped_release without_python;
        const std::scoped_lock lock(mutex_);
        listener_.close();
    }

    const stream::RunReceiver& run() const noexcept { return listener_.run(); }
    const std::vector<std::string>& notices() const noexcept { return notices_; }

private:
    stream::ListenerOptions with_notices(stream::ListenerOptions options) {
        options.notify = [this](const std::string& text) { notices_.push_back(text); };
        return options;
    }

    stream::ReceivedFrame* frame_or_nothing() {
        const py::gil_scoped_release without_python;
        const std::scoped_lock lock(mutex_);
        return listener_.receive(nap);
    }

    static py::object block_of(stream::ReceivedFrame& frame) {
        const stream::FrameHeader& header = frame.header;
        std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(header.n)};
        if (chain_taps.contains(frame.tap)) {
            shape.push_back(static_cast<py::ssize_t>(header.channels));
        }
        return py::make_tuple(array_of(std::move(frame.values), std::move(shape)), header.sample, header.fs,
                              header.seq, frame.missing, header.unit, header.run, header.epoch, header.burst,
                              header.burst_sample);
    }

    std::vector<std::string> notices_;
    std::mutex mutex_;  // of the listener: another thread may close it
    stream::Listener listener_;
};

std::unique_ptr<PythonListener> listen(const std::string& endpoint, const std::string& name,
                                       std::optional<double> timeout_s, const std::optional<std::string>& own,
                                       const std::optional<std::string>& server) {
    ArgumentFaults faults;
    if (const auto fault = stream::endpoint_fault(endpoint, stream::EndpointUse::connect)) {
        faults.add("endpoint: " + *fault);
    }
    const TapSet tap = taps_named("stream", {name}, streamed_taps, faults);
    if (timeout_s && !(*timeout_s > 0 && std::isfinite(*timeout_s))) {
        faults.add("timeout_s: found " + number_text(*timeout_s) + ", allowed: a finite number above 0 [s]");
    }
    const stream::ListenerOptions options{
        .taps = tap, .timeout_s = timeout_s, .curve = keys_of(own, server, faults)};
    faults.refuse();
    std::unique_ptr<PythonListener> listener;
    with_os_errors([&] { listener = std::make_unique<PythonListener>(endpoint, options); });
    return listener;
}

py::dict totals_of(const PythonListener& listener) {
    const stream::RunReceiver& run = listener.run();
    py::dict dict;
    dict["run"] = run.run();
    dict["fs"] = run.fs();
    dict["channels"] = run.channels();
    dict["first_sample"] = run.first_sample();
    dict["samples"] = run.totals().samples;
    dict.attr("update")(python_object(run.account()));
    dict["gapless"] = run.complete();
    dict["ended_by"] = word(run.end_reason());
    return dict;
}

}  // namespace

void add_listen(py::module_& module) {
    py::class_<PythonListener>(module, "Listener")
        .def("next", &PythonListener::next)
        .def("close", &PythonListener::close)
        .def_property_readonly("notices", &PythonListener::notices)
        .def_property_readonly("missing_at_end",
                               [](const PythonListener& listener) { return listener.run().missing_at_end(); })
        .def_property_readonly("refusal",
                               [](const PythonListener& listener) { return listener.run().refusal(); })
        .def_property_readonly("streams",
                               [](const PythonListener& listener) { return listener.run().streams(); })
        .def("provenance",
             [](const PythonListener& listener) { return python_object(listener.run().provenance()); })
        .def("totals", &totals_of);
    module.def("listen", &listen, py::arg("endpoint"), py::arg("stream"), py::arg("timeout_s"),
               py::arg("curve_key"), py::arg("server_key"));
}

}  // namespace hertzline::python
