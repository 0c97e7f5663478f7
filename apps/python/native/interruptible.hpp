#pragma once
// Long work that lets other threads of Python run, and that Ctrl-C ends.

#include <atomic>
#include <functional>

namespace hertzline::python {

/// A job that ends soon after `stop` is set.
using Work = std::function<void(const std::atomic<bool>& stop)>;

/// Does the work in a thread of its own, without the GIL. Meanwhile the calling thread looks for signals: when a handler
/// raises, such as that of Ctrl-C, it stops the work and waits for it. Needs the GIL. @param wake interrupts the work's
/// waiting when it is to stop @throws the work's exception, or py::error_already_set of the handler
void interruptible(const Work& work, const std::function<void()>& wake = {});

}  // namespace hertzline::python
