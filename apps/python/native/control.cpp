#include "apps/python/native/control.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/listen.hpp"
#include "apps/python/native/python_values.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "stream/control/control_client.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::python {

namespace {

/// The reply, an object. @param request JSON
py::object ask_control(const std::string& endpoint, const std::string& request, double timeout_s,
                       const std::optional<std::string>& own, const std::optional<std::string>& server) {
    constexpr double longest_s = 86400;
    ArgumentFaults faults;
    if (const auto fault = stream::endpoint_fault(endpoint, stream::EndpointUse::connect)) {
        faults.add("endpoint: " + *fault);
    }
    if (!(timeout_s > 0 && std::isfinite(timeout_s))) {
        faults.add("timeout_s: found " + number_text(timeout_s) + ", allowed: a finite number above 0 [s]");
    }
    stream::ControlConnection connection{.endpoint = endpoint, .curve = keys_of(own, server, faults)};
    faults.refuse();
    connection.timeout =
        std::chrono::milliseconds(std::llround(std::ceil(1000 * std::min(longest_s, timeout_s))));
    Json reply;
    with_os_errors([&] {
        interruptible([&](const std::atomic<bool>& stop) {
            reply = stream::ask_control(connection, json_from_outside(request), stop);
        });
    });
    return python_object(reply);
}

}  // namespace

void add_control(py::module_& module) {
    module.def("ask_control", &ask_control, py::arg("endpoint"), py::arg("request"), py::arg("timeout_s"),
               py::arg("curve_key"), py::arg("server_key"));
}

}  // namespace hertzline::python
