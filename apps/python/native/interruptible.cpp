#include "apps/python/native/interruptible.hpp"

#include <algorithm>
#include <chrono>
#include <future>

#include <pybind11/pybind11.h>

#include "recordings/recording_formats.hpp"

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

void interruptible(const Work& work) {
    bool raised = false;
    {
        const WithoutPython without_python;
        std::atomic<bool> stop{false};
        std::future<void> outcome = std::async(std::launch::async, std::cref(work), std::cref(stop));
        while (outcome.wait_for(between_looks) != std::future_status::ready) {
            if (!raised && signal_raised()) {
                raised = true;
                stop = true;
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

void interruptible_with_files(const std::vector<std::string>& paths, const Work& work) {
    const auto is_hdf5 = [](const std::string& path) { return recordings::recording_ending(path) == ".h5"; };
    if (std::ranges::any_of(paths, is_hdf5)) {
        const std::atomic<bool> never{false};
        work(never);
    } else {
        interruptible(work);
    }
}

}  // namespace hertzline::python
