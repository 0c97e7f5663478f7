#pragma once
// Lets one thread wait for another without a lock: it polls for a few microseconds, then sleeps until it is woken.
//
//     waiting thread                               another thread
//     sleeper.wait_until(deadline, condition);     change the condition's data;
//                                                  sleeper.wake_if(condition);
//
// Memory orders: both threads access asleep_ with read-modify-write operations, which have a single order. If the
// waiting thread's comes first, the other one sees it and wakes. Else the waiting thread sees the other's earlier
// change, and does not sleep. No wake-up is lost.

#include <atomic>
#include <cerrno>
#include <concepts>
#include <ctime>

#include <semaphore.h>

#include "stream/pipeline/pacer.hpp"

namespace hertzline::stream {

/// No deadline.
inline constexpr Nanoseconds never = Nanoseconds::max();

/// Where a thread sleeps, always the same one.
class Sleeper {
public:
    Sleeper() noexcept { sem_init(&wake_, /*pshared=*/0, /*value=*/0); }
    ~Sleeper() { sem_destroy(&wake_); }
    Sleeper(const Sleeper&) = delete;
    Sleeper& operator=(const Sleeper&) = delete;

    /// Waits; for the thread that sleeps. Returns when the condition holds, or at the deadline in the time of
    /// MonotonicClock. @returns whether the condition holds
    template <std::predicate Condition>
    bool wait_until(Nanoseconds deadline, Condition condition) noexcept {
        for (int look = 0; look < looks; ++look) {
            if (condition()) {
                return true;
            }
            pause();
        }
        bool in_time = true;
        bool holds = false;
        while (in_time && !holds) {
            asleep_.exchange(1, std::memory_order_acq_rel);
            holds = condition();
            in_time = holds || sleep(deadline);
        }
        asleep_.exchange(0, std::memory_order_acq_rel);
        return holds || condition();
    }

    /// Wakes the sleeper; for other threads, after a change. Takes a few nanoseconds when no thread sleeps.
    template <std::predicate Condition>
    void wake_if(Condition condition) noexcept {
        const bool asleep = asleep_.fetch_add(0, std::memory_order_acq_rel) != 0;
        if (asleep && condition() && asleep_.exchange(0, std::memory_order_acq_rel) != 0) {
            sem_post(&wake_);
        }
    }
    void wake() noexcept {
        wake_if([] { return true; });
    }

private:
    /// About as long as it takes to fall asleep and to be woken: some microseconds.
    static constexpr int looks = 100;

    /// Leaves the core's execution units to the other thread on it.
    static void pause() noexcept {
#if defined(__x86_64__)
        __builtin_ia32_pause();
#endif
    }

    /// Sleeps until woken, or interrupted by a signal. Returns false at the deadline.
    bool sleep(Nanoseconds deadline) noexcept {
        const timespec time{.tv_sec = deadline.count() / 1'000'000'000,
                            .tv_nsec = deadline.count() % 1'000'000'000};
        return sem_clockwait(&wake_, CLOCK_MONOTONIC, &time) == 0 || errno != ETIMEDOUT;
    }

    std::atomic<int> asleep_{0};
    sem_t wake_{};
};

}  // namespace hertzline::stream
