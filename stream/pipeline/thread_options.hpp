#pragma once
// What a system may grant a thread that must not be late. Where it does not, the stream goes on without.

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

/// Grants what the system allows. @returns a sentence for each wish that it refused.
/// Locks what the process has in memory at this moment: call it when all that the thread needs is there.
std::vector<std::string> grant(const ThreadOptions& wishes, pthread_t thread);

}  // namespace hertzline::stream
