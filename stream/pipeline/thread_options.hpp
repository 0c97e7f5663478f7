#pragma once
// Scheduling and memory options of a thread that must not be late. The stream continues without refused ones.

#include <optional>
#include <string>
#include <vector>

#include <pthread.h>

namespace hertzline::stream {

/// Scheduling of the simulating thread.
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

}  // namespace hertzline::stream
