#include "apps/python/native/interruptible.hpp"

#include <algorithm>
#include <chrono>
#include <future>

#include <cxxabi.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

#include "recordings/recording_formats.hpp"

namespace hertzline::python {

namespace {

namespace py = pybind11;

constexpr auto between_looks = std::chrono::milliseconds(50);  // for signals

}  // namespace

/// After the end of the interpreter Python ends a thread that asks for the GIL by an exception (pthread_exit). Destructors on its way would
/// ask once more, which aborts the process, and would wait for work; from version 3.14 on Python lets such threads wait, too.
void WithoutPython::restore() noexcept {
    try {
        PyEval_RestoreThread(state_);
    } catch (const abi::__forced_unwind&) {
        while (true) {
            ::pause();
        }
    }
}

bool WithoutPython::signal_raised() noexcept {
    restore();
    const bool raised = PyErr_CheckSignals() != 0;
    state_ = PyEval_SaveThread();
    return raised;
}

void interruptible(const Work& work) {
    bool raised = false;
    {
        WithoutPython without_python;
        std::atomic<bool> stop{false};
        std::future<void> outcome = std::async(std::launch::async, std::cref(work), std::cref(stop));
        while (outcome.wait_for(between_looks) != std::future_status::ready) {
            if (!raised && without_python.signal_raised()) {
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
