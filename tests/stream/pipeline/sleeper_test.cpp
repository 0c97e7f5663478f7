#include "stream/pipeline/sleeper.hpp"

#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

using namespace std::chrono_literals;

/// Returns the processor time of this thread so far.
Nanoseconds worked() {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return std::chrono::seconds(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           std::chrono::microseconds(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

TEST(Sleeper, WaitsToTheDeadlineAndBurnsNoCore) {
    Sleeper sleeper;
    const Nanoseconds begin = MonotonicClock::now();
    const Nanoseconds worked_before = worked();
    EXPECT_FALSE(sleeper.wait_until(begin + 300ms, [] { return false; }));
    EXPECT_GE(MonotonicClock::now(), begin + 300ms);
    EXPECT_LT(worked() - worked_before, 30ms);
}

TEST(Sleeper, DoesNotSleepWhenTheConditionHoldsAlready) {
    Sleeper sleeper;
    EXPECT_TRUE(sleeper.wait_until(never, [] { return true; }));
    EXPECT_TRUE(sleeper.wait_until(Nanoseconds{0}, [] { return true; }));
}

TEST(Sleeper, IsNotWokenBeforeTheConditionHolds) {
    Sleeper sleeper;
    std::atomic<int> count{0};
    std::atomic<int> looks{0};
    constexpr int enough = 20;
    std::thread sleeping([&] {
        EXPECT_TRUE(sleeper.wait_until(never, [&] {
            ++looks;
            return count.load() == enough;
        }));
    });
    EXPECT_TRUE(eventually([&] { return looks.load() > 0; }));
    std::this_thread::sleep_for(100ms);  // then it has fallen asleep
    const int before = looks.load();
    for (int i = 0; i < enough; ++i) {
        std::this_thread::sleep_for(1ms);
        ++count;
        sleeper.wake_if([&] { return count.load() == enough; });
    }
    sleeping.join();
    EXPECT_LE(looks.load(), before + 2);
}

// Without deadlines: one lost wake-up and the test never ends.
TEST(Sleeper, LosesNoWakeUp) {
    constexpr int rounds = 100'000;
    Sleeper even;
    Sleeper odd;
    std::atomic<int> turn{0};
    const auto play = [&](int parity, Sleeper& own, Sleeper& other) {
        for (int round = parity; round < rounds; round += 2) {
            own.wait_until(never, [&] { return turn.load(std::memory_order_acquire) == round; });
            if (round % 512 < 2) {
                std::this_thread::sleep_for(100us);  // so that the other one does fall asleep
            }
            turn.store(round + 1, std::memory_order_release);
            other.wake();
        }
    };
    std::thread second([&] { play(1, odd, even); });
    play(0, even, odd);
    second.join();
    EXPECT_EQ(turn.load(), rounds);
}

}  // namespace
}  // namespace hertzline::test
