#pragma once
// Threads that compute beside those that keep step with the clock.

#include <pthread.h>
#include <sys/resource.h>

namespace hertzline::stream {

/// For the calling thread, at its start: gives it a name, as the system's tools list it (top -H), and a lower priority.
/// @param nice from 1 to 19, the lowest. On Linux a priority is the calling thread's.
inline void begin_background_thread(const char* name, int nice) noexcept {
    pthread_setname_np(pthread_self(), name);
    setpriority(PRIO_PROCESS, 0, nice);
}

}  // namespace hertzline::stream
