#pragma once
// Long work that Python can go on beside, and that Ctrl-C ends.

#include <atomic>
#include <functional>

namespace hertzline::python {

/// What it takes is set when it should end soon.
using Work = std::function<void(const std::atomic<bool>& stop)>;

/// Does the work in a thread of its own, without the GIL. The calling thread looks for signals meanwhile: when a handler raises, as that
/// of Ctrl-C does, the work is asked to stop and waited for. To be called with the GIL. @param wake ends what the work may wait for,
/// when it is asked to stop @throws what the work throws, or py::error_already_set of the handler
void interruptible(const Work& work, const std::function<void()>& wake = {});

}  // namespace hertzline::python
