#pragma once
// Long work that lets other threads of Python run, and that Ctrl-C ends.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <Python.h>

namespace hertzline::python {

/// A job that ends soon after `stop` is set.
using Work = std::function<void(const std::atomic<bool>& stop)>;

/// Does the work in a thread of its own, without the GIL. Meanwhile the calling thread looks for signals: when a handler
/// raises, such as that of Ctrl-C, it stops the work and waits for it. Needs the GIL.
/// @throws the work's exception, or py::error_already_set of the handler
void interruptible(const Work& work);

/// interruptible(); but work on an HDF5 file keeps the GIL and goes to its end: one thread at a time may enter that library, and h5py
/// holds the GIL when it does.
void interruptible_with_files(const std::vector<std::string>& paths, const Work& work);

/// Lets other threads of Python run while it lives. A daemon thread that wants to go on after the interpreter stays here until the process
/// ends.
class WithoutPython {
public:
    WithoutPython() noexcept : state_(PyEval_SaveThread()) {}
    ~WithoutPython() { restore(); }
    WithoutPython(const WithoutPython&) = delete;
    WithoutPython& operator=(const WithoutPython&) = delete;

    /// Whether a handler of a signal has raised.
    bool signal_raised() noexcept;

private:
    void restore() noexcept;

    PyThreadState* state_;
};

}  // namespace hertzline::python
