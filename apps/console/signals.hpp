#pragma once

#include <atomic>

namespace hertzline::app {

/// From the first call on, Ctrl-C, SIGTERM and a closed terminal set this flag instead of ending the program;
/// system calls that wait are interrupted.
const std::atomic<bool>& stop_asked();

/// From here on nothing is left to be saved: they end the program at once, with exit status 1.
void end_at_once_when_asked();

/// Whether the flag is set; catches no signal.
bool stop_was_asked() noexcept;

}  // namespace hertzline::app
