#pragma once
// The scheduling of threads: of one that must not be late, and of those that compute beside it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pthread.h>

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

/// While it lives, the calling thread is woken at the time that it asks for. The system else takes 50 us more, to wake
/// several threads at once.
class PunctualWaking {
public:
    PunctualWaking() noexcept;
    ~PunctualWaking();
    PunctualWaking(const PunctualWaking&) = delete;
    PunctualWaking& operator=(const PunctualWaking&) = delete;

private:
    unsigned long slack_before_ns_;
};

/// While it lives, the calling thread and those that it starts run soon after they are woken, although others compute on
/// their processor: they ask for short slices of time (Linux 6.12 and later). For threads that rest most of the time.
class ShortSlices {
public:
    ShortSlices() noexcept;
    ~ShortSlices();
    ShortSlices(const ShortSlices&) = delete;
    ShortSlices& operator=(const ShortSlices&) = delete;

private:
    std::optional<std::uint64_t> before_;  // [ns], if they could be changed
};

/// For the calling thread, at its start: gives it a name, as the system's tools list it (top -H), a lower priority, and slices
/// of the usual length. @param nice from 1 to 19, the lowest. On Linux a priority is the calling thread's.
void begin_background_thread(const char* name, int nice) noexcept;

}  // namespace hertzline::stream
