#pragma once

#include <atomic>

namespace hertzline::app {

/// Makes Ctrl-C, SIGTERM and a closed terminal end the program at once, with exit status 1, while there is nothing to
/// be saved.
void end_at_once_when_asked();

/// Makes them set this flag instead of ending the program; waiting system calls are interrupted.
const std::atomic<bool>& stop_asked();

/// After end_at_once_when_asked(): makes them set the flag again.
void note_when_asked() noexcept;

/// Whether the flag is set; catches no signal.
bool stop_was_asked() noexcept;

}  // namespace hertzline::app
