#include "stream/threads.hpp"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace hertzline::stream {

namespace {

/// Before every ordinary thread, behind the kernel's own (interrupt threads have 50).
constexpr int priority = 10;

std::string reason(int error) {
    return std::generic_category().message(error);
}

int pin(pthread_t thread, int cpu) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<unsigned>(cpu), &set);
    return pthread_setaffinity_np(thread, sizeof set, &set);
}

int put_first(pthread_t thread) {
    const sched_param parameters{.sched_priority = priority};
    return pthread_setschedparam(thread, SCHED_FIFO, &parameters);
}

}  // namespace

std::optional<std::string> cpu_fault(int cpu) {
    const long processors = sysconf(_SC_NPROCESSORS_CONF);
    if (cpu >= 0 && cpu < processors && cpu < CPU_SETSIZE) {
        return std::nullopt;
    }
    return fmt::format("found {}, allowed: 0 to {}", cpu, processors - 1);
}

std::vector<std::string> apply(const ThreadOptions& options, pthread_t thread) {
    std::vector<std::string> refused;
    if (options.cpu) {
        if (const int error = pin(thread, *options.cpu); error != 0) {
            refused.push_back(
                fmt::format("the simulating thread cannot be kept on processor {}: {}; it runs on any",
                            *options.cpu, reason(error)));
        }
    }
    if (options.realtime_priority) {
        if (const int error = put_first(thread); error != 0) {
            refused.push_back(
                fmt::format("no real-time priority: {}; the priority stays ordinary (it needs "
                            "CAP_SYS_NICE, or rtprio {} in limits.conf)",
                            reason(error), priority));
        }
        // Not later memory: the queues of slow subscribers would fail to grow at the system's limit.
        if (mlockall(MCL_CURRENT) != 0) {
            refused.push_back(
                fmt::format("memory cannot be locked: {}; it may be swapped out (it needs "
                            "CAP_IPC_LOCK, or memlock in limits.conf)",
                            reason(errno)));
        }
    }
    return refused;
}

void wake_on_time() noexcept {
    constexpr unsigned long slack_ns = 1;
    prctl(PR_SET_TIMERSLACK, slack_ns);
}

}  // namespace hertzline::stream
