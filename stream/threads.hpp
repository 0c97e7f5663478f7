#pragma once
// The scheduling of threads: of one that must not be late, and of those that compute beside it.

#include <optional>
#include <string>
#include <vector>

#include <pthread.h>
#include <sys/resource.h>

namespace hertzline::stream {

/// Scheduling of the simulating thread. The stream continues without refused options.
struct ThreadOptions {
    bool realtime_priority = false;  ///< before every ordinary thread (SCHED_FIFO), and memory that stays
    std::optional<int> cpu;          ///< the only one that it runs on
};

/// Returns the fault of a processor's number: "found 7, allowed: 0 to 3".
std::optional<std::string> cpu_fault(int cpu);

/// Applies the options. @returns a sentence for each that the system refused.
/// Locks the process's present memory: call it when all memory of the thread is allocated.
std::vector<std::string> apply(const ThreadOptions& options, pthread_t thread);

/// The calling thread shall be woken at the time that it asks for. The system else takes 50 us more, to wake several
/// threads at once.
void wake_on_time() noexcept;

/// For the calling thread, at its start: gives it a name, as the system's tools list it (top -H), and a lower priority.
/// @param nice from 1 to 19, the lowest. On Linux a priority is the calling thread's.
inline void begin_background_thread(const char* name, int nice) noexcept {
    pthread_setname_np(pthread_self(), name);
    setpriority(PRIO_PROCESS, 0, nice);
}

}  // namespace hertzline::stream
