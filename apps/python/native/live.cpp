#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>
#include <unistd.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"
#include "measures/tap_names.hpp"
#include "stream/control/control_client.hpp"
#include "stream/listening/listener.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/security/certificate.hpp"

namespace hertzline::python {

namespace {

/// Reads the keys of an encrypted stream, or adds their faults; none without files.
std::optional<stream::CurveClient> keys_of(const std::optional<std::string>& own,
                                           const std::optional<std::string>& server, Faults& faults) {
    return stream::read_client_keys(own.value_or(""), server.value_or(""), "curve_key", "server_key", faults);
}

constexpr auto nap = std::chrono::milliseconds(100);  // between looks at signals

/// A listener that lets other threads of Python run while it waits. For one thread at a time, except close().
class PythonListener {
public:
    PythonListener(const std::string& endpoint, stream::ListenerOptions options)
        : listener_(std::make_unique<stream::Listener>(endpoint, with_notices(std::move(options)))) {}
    /// In a process that was forked the threads of ZeroMQ are missing, and its sockets cannot be closed.
    ~PythonListener() {
        if (is_forked()) {
            static_cast<void>(listener_.release());
        }
    }
    PythonListener(const PythonListener&) = delete;
    PythonListener& operator=(const PythonListener&) = delete;

    /// Returns (samples, header's numbers, missing) of the next frame; None at the end. @throws py::error_already_set of a signal handler
    py::object next() {
        while (true) {
            bool ended = false;
            if (stream::ReceivedFrame* frame = frame_or_nothing(ended)) {
                return block_of(*frame);
            }
            if (ended) {
                return py::none();
            }
            if (PyErr_CheckSignals() != 0) {
                throw py::error_already_set();
            }
        }
    }

    void close() {
        const WithoutPython without_python;
        if (!is_forked()) {
            const std::scoped_lock lock(mutex_);
            listener_->close();
        }
    }

    const stream::RunReceiver& run() const noexcept { return listener_->run(); }
    const std::vector<std::string>& notices() const noexcept { return notices_; }

private:
    bool is_forked() const noexcept { return ::getpid() != owner_; }

    stream::ListenerOptions with_notices(stream::ListenerOptions options) {
        options.notify = [this](const std::string& text) { notices_.push_back(text); };
        return options;
    }

    /// @param ended whether the listener has
    stream::ReceivedFrame* frame_or_nothing(bool& ended) {
        const WithoutPython without_python;
        const std::scoped_lock lock(mutex_);
        stream::ReceivedFrame* frame = listener_->ended() ? nullptr : listener_->receive(nap);
        ended = listener_->ended();
        return frame;
    }

    static py::object block_of(stream::ReceivedFrame& frame) {
        const stream::FrameHeader& header = frame.header;
        std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(header.n)};
        const auto channels = static_cast<std::size_t>(header.channels);
        if (has_channels(frame.tap, {.spheres = channels, .points = channels, .elements = channels})) {
            shape.push_back(static_cast<py::ssize_t>(channels));
        }
        return py::make_tuple(array_of(std::move(frame.values), std::move(shape)), header.sample, header.fs,
                              header.seq, frame.missing, header.unit, header.run, header.epoch, header.burst,
                              header.burst_sample);
    }

    std::vector<std::string> notices_;
    std::mutex mutex_;  // of the listener: another thread may close it
    pid_t owner_ = ::getpid();
    std::unique_ptr<stream::Listener> listener_;
};

std::unique_ptr<PythonListener> listen(const std::string& endpoint, const std::string& name,
                                       std::optional<double> timeout_s, const std::optional<std::string>& own,
                                       const std::optional<std::string>& server) {
    Faults faults;
    faults.add("endpoint", stream::endpoint_fault(endpoint, stream::EndpointUse::connect));
    const TapSet tap = measures::taps_named("stream", {name}, streamed_taps, faults);
    faults.add("timeout_s", positive_fault(timeout_s, "[s]"));
    const stream::ListenerOptions options{
        .taps = tap, .timeout_s = timeout_s, .curve = keys_of(own, server, faults)};
    faults.refuse<py::value_error>();
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

/// Sends a request and returns the reply, an object. @param request JSON
py::object ask_control(const std::string& request, const std::string& endpoint, double timeout_s,
                       const std::optional<std::string>& own, const std::optional<std::string>& server) {
    Faults faults;
    faults.add("endpoint", stream::endpoint_fault(endpoint, stream::EndpointUse::connect));
    faults.add("timeout_s", positive_fault(timeout_s, "[s]"));
    const stream::ControlConnection connection{
        .endpoint = endpoint, .curve = keys_of(own, server, faults), .timeout_s = timeout_s};
    faults.refuse<py::value_error>();
    Json reply;
    with_os_errors([&] {
        interruptible([&](const std::atomic<bool>& stop) {
            reply = stream::ask_control(connection, json_from_outside(request), stop);
        });
    });
    return python_object(reply);
}

}  // namespace

void add_live(py::module_& module) {
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
    module.def("ask_control", &ask_control, py::arg("request"), py::arg("endpoint"), py::arg("timeout_s"),
               py::arg("curve_key"), py::arg("server_key"));
}

}  // namespace hertzline::python
