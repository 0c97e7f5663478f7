#include "apps/python/native/interruptible.hpp"

#include <chrono>
#include <future>

#include <pybind11/pybind11.h>

namespace hertzline::python {

namespace {

namespace py = pybind11;

constexpr auto between_looks = std::chrono::milliseconds(50);  // for signals

/// Whether a handler has raised. Needs no GIL.
bool signal_raised() {
    const py::gil_scoped_acquire with_python;
    return PyErr_CheckSignals() != 0;
}

}  // namespace

void interruptible(const Work& work, const std::function<void()>& wake) {
    bool raised = false;
    {
        const py::gil_scoped_release without_python;
        std::atomic<bool> stop{false};
        std::future<void> outcome = std::async(std::launch::async, std::cref(work), std::cref(stop));
        while (outcome.wait_for(between_looks) != std::future_status::ready) {
            if (!raised && signal_raised()) {
                raised = true;
                stop = true;
                if (wake) {
                    wake();
                }
            }
        }
        if (!raised) {
            outcome.get();
        }
    }
    if (raised) {
        throw py::error_already_set();
    }
}

}  // namespace hertzline::python
