#pragma once
// What the system may do for a thread that must not be late. Where it refuses, the stream goes on without.

#include <optional>
#include <string>
#include <vector>

#include <pthread.h>

namespace hertzline::stream {

/// How the simulating thread is scheduled.
struct ThreadOptions {
    bool realtime_priority = false;  ///< before every ordinary thread (SCHED_FIFO), and memory that stays
    std::optional<int> cpu;          ///< the only one that it runs on
};

/// Why there is no such processor: "found 7, allowed: 0 to 3".
std::optional<std::string> cpu_fault(int cpu);

/// Applies what the system allows. @returns a sentence for each option that it refused.
/// Locks what the process has in memory at this moment: call it when all that the thread needs is there.
std::vector<std::string> apply(const ThreadOptions& options, pthread_t thread);

/// The calling thread shall be woken at the time that it asks for. The system else takes 50 us more, to wake several
/// threads at once.
void wake_on_time() noexcept;

}  // namespace hertzline::stream
