#include "apps/python/native/interruptible.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include <pybind11/pybind11.h>

namespace hertzline::python {

namespace {

namespace py = pybind11;

constexpr auto between_looks = std::chrono::milliseconds(50);  // for signals

/// A thread that does the work, and its outcome.
class Worker {
public:
    explicit Worker(const Work& work) : thread_([this, &work] { run(work); }) {}

    void ask_to_stop() noexcept { stop_ = true; }
    bool wait() {
        std::unique_lock lock(mutex_);
        return ended_.wait_for(lock, between_looks, [this] { return over_; });
    }
    /// Throws the work's exception. Call it when the work is over.
    void rethrow() {
        if (failure_) {
            std::rethrow_exception(failure_);
        }
    }

private:
    void run(const Work& work) noexcept {
        try {
            work(stop_);
        } catch (...) {
            failure_ = std::current_exception();
        }
        const std::scoped_lock lock(mutex_);
        over_ = true;
        ended_.notify_all();
    }

    std::atomic<bool> stop_{false};
    std::mutex mutex_;  // of over_
    std::condition_variable ended_;
    bool over_ = false;
    std::exception_ptr failure_;
    std::jthread thread_;  // last: it uses the others
};

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
        Worker worker(work);
        while (!worker.wait()) {
            if (!raised && signal_raised()) {
                raised = true;
                worker.ask_to_stop();
                if (wake) {
                    wake();
                }
            }
        }
        if (!raised) {
            worker.rethrow();
        }
    }
    if (raised) {
        throw py::error_already_set();
    }
}

}  // namespace hertzline::python
