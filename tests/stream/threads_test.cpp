#include "stream/threads.hpp"

#include <thread>

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace hertzline::test {

using namespace stream;
namespace {

TEST(ThreadOptions, AProcessorThatDoesNotExistIsNamedWithThoseThatDo) {
    EXPECT_FALSE(cpu_fault(0));
    ASSERT_TRUE(cpu_fault(-1));
    EXPECT_EQ(cpu_fault(100'000)->rfind("found 100000, allowed: 0 to ", 0), 0U) << *cpu_fault(100'000);
}

/// The slices of the calling thread [ns], from sched_getattr(2).
std::uint64_t slices() {
    struct {
        std::uint32_t size, policy;
        std::uint64_t flags;
        std::int32_t nice;
        std::uint32_t priority;
        std::uint64_t slice_ns, deadline_ns, period_ns;
    } scheduling{};
    syscall(SYS_sched_getattr, 0, &scheduling, sizeof scheduling, 0);
    return scheduling.slice_ns;
}

TEST(PunctualWaking, EndsWithItsScope) {
    const int usual = prctl(PR_GET_TIMERSLACK);
    ASSERT_GT(usual, 1);
    {
        const PunctualWaking on_time;
        EXPECT_EQ(prctl(PR_GET_TIMERSLACK), 1);
    }
    EXPECT_EQ(prctl(PR_GET_TIMERSLACK), usual);
}

TEST(ShortSlices, AreThoseOfTheThreadAndOfThoseThatItStartsButNotOfABackgroundThread) {
    const std::uint64_t usual = slices();
    if (usual == 0) {
        GTEST_SKIP() << "this system gives all threads the same slices";
    }
    std::uint64_t own = 0, inherited = 0, background = 0;
    {
        const ShortSlices prompt;
        own = slices();
        std::thread([&] {
            inherited = slices();
            begin_background_thread("background", 1);
            background = slices();
        }).join();
    }
    EXPECT_LT(own, usual);
    EXPECT_EQ(inherited, own);
    EXPECT_EQ(background, usual);
    EXPECT_EQ(slices(), usual);
}

}  // namespace
}  // namespace hertzline::test
