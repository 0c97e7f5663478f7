#include "apps/python/native/listen.hpp"

#include <chrono>
#include <cmath>
#include <limits>
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
#include "stream/listening/received_run.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/security/certificate.hpp"
#include "stream/wire/subscriber.hpp"

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

using Clock = std::chrono::steady_clock;

constexpr auto nap = std::chrono::milliseconds(100);  // between looks at the clock and at signals
constexpr double usual_patience_s = 15;  // with a stream that was heard; it sends its meta once a second

/// A connection, and what has come of it. For one thread at a time, but for close().
class Listener {
public:
    Listener(const std::string& endpoint, Tap tap, std::optional<double> timeout_s,
             const stream::SubscriberOptions& options)
        : received_(tap, [this](const std::string& text) { notices_.push_back(text); }),
          timeout_s_(timeout_s),
          subscriber_(std::in_place, endpoint, options) {
        subscriber_->subscribe(stream::meta_topic);
        subscriber_->subscribe(stream::end_topic);
    }

    /// (samples, header's numbers, missing) of the next frame; None at the end. @throws py::error_already_set of a signal handler
    py::object next() {
        Clock::time_point heard = Clock::now();
        while (received_.end_reason() == stream::EndReason::none) {
            if (stream::ReceivedFrame* frame = frame_or_nothing(heard)) {
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
        subscriber_.reset();
        if (received_.end_reason() == stream::EndReason::none) {
            received_.end(stream::EndReason::stopped);
        }
    }

    const stream::ReceivedRun& received() const noexcept { return received_; }
    const std::vector<std::string>& notices() const noexcept { return notices_; }

private:
    double patience_s() const {
        return timeout_s_.value_or(received_.heard_samples() ? usual_patience_s
                                                             : std::numeric_limits<double>::infinity());
    }

    /// Waits a moment for a message. Without the GIL.
    stream::ReceivedFrame* frame_or_nothing(Clock::time_point& heard) {
        const py::gil_scoped_release without_python;
        const std::scoped_lock lock(mutex_);
        if (!subscriber_) {
            return nullptr;
        }
        stream::ReceivedFrame* frame = nullptr;
        if (const stream::Message* message = subscriber_->receive(nap)) {
            const bool knew_the_run = received_.knows_the_run();
            frame = received_.take(*message);
            heard = Clock::now();
            if (received_.knows_the_run() && !knew_the_run) {
                subscriber_->subscribe(received_.topic());  // not before: a frame needs to be known
            }
        } else if (std::chrono::duration<double>(Clock::now() - heard).count() > patience_s()) {
            received_.end(stream::EndReason::silence);
        }
        if (const auto refusal = subscriber_->refusal()) {
            received_.note_refusal(*refusal);
        }
        return frame;
    }

    static py::object block_of(stream::ReceivedFrame& frame) {
        const stream::FrameHeader& header = frame.header;
        std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(header.n)};
        if (const auto tap = tap_named(header.stream); tap && chain_taps.contains(*tap)) {
            shape.push_back(static_cast<py::ssize_t>(header.channels));
        }
        return py::make_tuple(array_of(std::move(frame.values), std::move(shape)), header.sample, header.fs,
                              header.seq, frame.missing, header.unit, header.run, header.epoch, header.burst,
                              header.burst_sample);
    }

    std::vector<std::string> notices_;
    stream::ReceivedRun received_;
    std::optional<double> timeout_s_;
    std::mutex mutex_;                              // of the next one: another thread may close
    std::optional<stream::Subscriber> subscriber_;  // nothing: closed
};

std::unique_ptr<Listener> listen(const std::string& endpoint, const std::string& name,
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
    const stream::SubscriberOptions options{.curve = keys_of(own, server, faults)};
    faults.refuse();
    std::unique_ptr<Listener> listener;
    with_os_errors(
        [&] { listener = std::make_unique<Listener>(endpoint, *tap.begin(), timeout_s, options); });
    return listener;
}

py::dict totals_of(const Listener& listener) {
    const stream::ReceivedRun& received = listener.received();
    py::dict dict;
    dict["run"] = received.run();
    dict["fs"] = received.fs();
    dict["channels"] = received.channels();
    dict["first_sample"] = received.first_sample();
    dict["samples"] = received.totals().samples;
    dict.attr("update")(python_object(received.account()));
    dict["gapless"] = received.sound();
    dict["ended_by"] = word(received.end_reason());
    return dict;
}

}  // namespace

void add_listen(py::module_& module) {
    py::class_<Listener>(module, "Listener")
        .def("next", &Listener::next)
        .def("close", &Listener::close)
        .def_property_readonly("notices", &Listener::notices)
        .def_property_readonly("missing_at_end",
                               [](const Listener& listener) { return listener.received().missing_at_end(); })
        .def_property_readonly("refusal",
                               [](const Listener& listener) { return listener.received().refusal(); })
        .def_property_readonly("streams",
                               [](const Listener& listener) { return listener.received().streams(); })
        .def("provenance",
             [](const Listener& listener) { return python_object(listener.received().provenance()); })
        .def("totals", &totals_of);
    module.def("listen", &listen, py::arg("endpoint"), py::arg("stream"), py::arg("timeout_s"),
               py::arg("curve_key"), py::arg("server_key"));
}

}  // namespace hertzline::python
