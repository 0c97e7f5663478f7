#pragma once

#include <atomic>

namespace hertzline::app {

/// From here on Ctrl-C, SIGTERM and a closed terminal end the program at once, with exit status 1: there is nothing to
/// be saved.
void end_at_once_when_asked();

/// From here on they set this flag instead of ending the program; system calls that wait are interrupted.
const std::atomic<bool>& stop_asked();

/// After end_at_once_when_asked(): from here on they set the flag again.
void note_when_asked() noexcept;

/// Whether the flag is set; catches no signal.
bool stop_was_asked() noexcept;

}  // namespace hertzline::app
