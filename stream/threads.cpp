#include "stream/threads.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace hertzline::stream {

namespace {

/// Before every ordinary thread, behind the kernel's own (interrupt threads have 50).
constexpr int priority = 10;

constexpr std::uint64_t short_slice_ns = 100'000;
constexpr std::uint64_t usual_slice_ns = 0;

/// The arguments of sched_setattr(2), which has no header yet.
struct Scheduling {
    std::uint32_t size = sizeof(Scheduling);
    std::uint32_t policy = 0;
    std::uint64_t flags = 0;
    std::int32_t nice = 0;
    std::uint32_t priority = 0;
    std::uint64_t slice_ns = 0;
    std::uint64_t deadline_ns = 0;
    std::uint64_t period_ns = 0;
    std::uint32_t least_use = 0;
    std::uint32_t most_use = 0;
};

/// Sets the slices of the calling thread. @returns those before; nothing when it has no slices, or the system refused
std::optional<std::uint64_t> set_slices(std::uint64_t slice_ns) noexcept {
    Scheduling scheduling;
    if (syscall(SYS_sched_getattr, 0, &scheduling, sizeof scheduling, 0) != 0 ||
        scheduling.policy != SCHED_OTHER) {
        return std::nullopt;
    }
    const std::uint64_t before = std::exchange(scheduling.slice_ns, slice_ns);
    return syscall(SYS_sched_setattr, 0, &scheduling, 0) == 0 ? std::optional(before) : std::nullopt;
}

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

PunctualWaking::PunctualWaking() noexcept
    : slack_before_ns_(static_cast<unsigned long>(prctl(PR_GET_TIMERSLACK))) {
    constexpr unsigned long slack_ns = 1;
    prctl(PR_SET_TIMERSLACK, slack_ns);
}

PunctualWaking::~PunctualWaking() {
    prctl(PR_SET_TIMERSLACK, slack_before_ns_);
}

ShortSlices::ShortSlices() noexcept : before_(set_slices(short_slice_ns)) {}

ShortSlices::~ShortSlices() {
    if (before_) {
        set_slices(*before_);
    }
}

void begin_background_thread(const char* name, int nice) noexcept {
    pthread_setname_np(pthread_self(), name);
    setpriority(PRIO_PROCESS, 0, nice);
    set_slices(usual_slice_ns);
}

}  // namespace hertzline::stream
