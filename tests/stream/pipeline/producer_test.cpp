// The simulating thread's half of a stream, with a source that costs nothing.

#include "stream/pipeline/producer.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>

#include "tests/support/counting_source.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace stream;
using testing::HasSubstr;
namespace {

constexpr std::size_t slots = 4;
constexpr RingSize four{.blocks = slots};
constexpr StreamFormat format{.taps = TapSet(Tap::v_out),
                              .counts = {.spheres = 1, .points = 2},
                              .sample_rate_hz = 1e6,
                              .frame_samples = 10};

/// Returns a clock that has run for a day: every block is late.
Pacer long_ago() {
    Pacer pacer(format.sample_rate_hz, Pace::realtime());
    pacer.start(MonotonicClock::now() - std::chrono::hours(24));
    return pacer;
}

void wait_for(const Producer& producer) {
    while (!producer.finished()) {
        MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::milliseconds(1));
    }
}

/// Takes all blocks until the end.
std::vector<Block> drained(Producer& producer) {
    std::vector<Block> blocks;
    while (true) {
        const bool finished = producer.finished();
        if (const Block* block = producer.front()) {
            blocks.push_back(*block);
            producer.pop();
        } else if (finished) {
            return blocks;
        }
    }
}

TEST(Producer, DiscardsAndCountsWhatIsLateWhileTheRingIsFull) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1000, OnOverrun::drop);
    producer.want(format.taps);
    producer.start({});
    producer.go();
    wait_for(producer);  // no reader
    EXPECT_EQ(producer.dropped(), 100 - slots);
    EXPECT_EQ(drained(producer).size(), slots);
    EXPECT_EQ(source.next_sample(), 1000);
}

TEST(Producer, NumbersGoOnPastWhatWasDiscarded) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, std::nullopt, OnOverrun::drop);
    producer.want(format.taps);
    producer.start({});
    producer.go();
    ASSERT_TRUE(eventually([&] { return producer.dropped() >= 10; }));
    for (std::size_t taken = 0; taken < slots + 10; ++taken) {
        ASSERT_TRUE(eventually([&] { return producer.front() != nullptr; }));
        const Block& block = *producer.front();
        if (taken < slots) {
            EXPECT_EQ(block.seq, taken);
        } else {
            EXPECT_GE(block.dropped, 10U);
            EXPECT_GE(block.seq, taken + 10);
        }
        EXPECT_EQ(block.samples().first, static_cast<std::int64_t>(block.seq) * format.frame_samples);
        EXPECT_EQ(block.samples()[Tap::v_out][0], static_cast<double>(block.samples().first));
        producer.pop();
    }
}

TEST(Producer, WaitsRatherThanDiscardWhenToldSo) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1000, OnOverrun::wait);
    producer.start({});
    producer.go();
    EXPECT_TRUE(eventually([&] { return producer.ring().size() == slots; }));
    MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::milliseconds(20));
    EXPECT_EQ(producer.ring().size(), slots);
    EXPECT_FALSE(producer.finished());
    EXPECT_EQ(drained(producer).size(), 100U);
    EXPECT_EQ(producer.dropped(), 0U);
}

TEST(Producer, EndsWithTheSource) {
    CountingSource source(format, 55);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, std::nullopt, OnOverrun::wait);
    producer.start({});
    producer.go();
    const std::vector<Block> blocks = drained(producer);
    ASSERT_EQ(blocks.size(), 6U);
    EXPECT_EQ(blocks.back().samples().count, 5U);
}

TEST(Producer, StopsWhileItWaitsForASlotAndBeforeItBegan) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer waiting(source, pacer, four, std::nullopt, OnOverrun::wait);
    waiting.start({});
    waiting.stop();
    EXPECT_EQ(source.next_sample(), 0);
    Producer full(source, pacer, four, std::nullopt, OnOverrun::wait);
    full.start({});
    full.go();
    while (full.ring().size() < slots) {
        MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::milliseconds(1));
    }
    full.stop();
    EXPECT_TRUE(full.finished());
}

/// Returns the number of that key in the system's status of a thread.
long status_of(pid_t thread, const std::string& wanted) {
    std::ifstream status("/proc/self/task/" + std::to_string(thread) + "/status");
    for (std::string key; status >> key;) {
        if (long number = 0; key == wanted && status >> number) {
            return number;
        }
    }
    ADD_FAILURE() << "no " << wanted;
    return 0;
}

/// Returns the simulating thread of this process, once it has its name.
pid_t simulating_thread() {
    pid_t found = 0;
    EXPECT_TRUE(eventually([&] {
        for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
            std::string name;
            if (std::getline(std::ifstream(task.path() / "comm"), name); name == simulating_thread_name) {
                found = std::stoi(task.path().filename());
            }
        }
        return found != 0;
    }));
    return found;
}

/// Waits until the thread does not wake up for a while.
bool falls_asleep(int thread) {
    return eventually([&] {
        const long before = status_of(thread, "voluntary_ctxt_switches:");
        MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::milliseconds(100));
        return status_of(thread, "voluntary_ctxt_switches:") == before;
    });
}

TEST(Producer, SleepsWhileTheRingIsFull) {
    constexpr std::size_t many = 64;
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, {.blocks = many}, std::nullopt, OnOverrun::wait);
    producer.start({});
    producer.go();
    ASSERT_TRUE(eventually([&] { return producer.ring().size() == many; }));
    EXPECT_TRUE(falls_asleep(simulating_thread())) << "it wakes up although nothing has changed";
}

TEST(Producer, FillsTheRingAgainWhenAsMuchIsFreeAsItIsTold) {
    constexpr std::size_t many = 64;
    for (const auto& [refill, free] : {std::pair<std::size_t, std::size_t>{10, 10}, {100, many / 4}}) {
        CountingSource source(format);
        const Pacer pacer = long_ago();
        Producer producer(source, pacer, {.blocks = many, .refill = refill}, std::nullopt, OnOverrun::wait);
        producer.start({});
        producer.go();
        const auto full = [&] { return producer.ring().size() == many; };
        ASSERT_TRUE(eventually(full));
        ASSERT_TRUE(falls_asleep(simulating_thread()));
        for (std::size_t taken = 1; taken < free; ++taken) {
            ASSERT_NE(producer.front(), nullptr);
            producer.pop();
        }
        MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::milliseconds(50));
        EXPECT_EQ(producer.ring().size(), many + 1 - free) << "woken for less than " << free;
        producer.pop();
        EXPECT_TRUE(eventually(full)) << free;
    }
}

TEST(Producer, HasRoomOfItsOwnForBlocksWithEverySphere) {
    const StreamFormat chain{.taps = TapSet(Tap::v_out) | Tap::v_chain,
                             .counts = {.spheres = 3, .points = 2},
                             .sample_rate_hz = 1e6,
                             .frame_samples = 10};
    CountingSource source(chain);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, {.blocks = 40, .chain_blocks = 4}, 1000, OnOverrun::wait);
    producer.want(chain.taps);
    producer.start({});
    producer.go();
    EXPECT_TRUE(eventually([&] { return producer.ring().size() == 4; }));
    producer.want(TapSet(Tap::v_out));  // wakes it up: of these there is room for more
    EXPECT_TRUE(eventually([&] { return producer.ring().size() == 40; }));
    producer.want(chain.taps);
    std::int64_t next = 0;
    while (const Block* block = producer.front()) {
        const Samples& samples = block->samples();
        EXPECT_EQ(samples.first, next);
        next += static_cast<std::int64_t>(samples.count);
        for (const Tap tap : block->demand.taps) {
            EXPECT_EQ(samples[tap].size(), samples.count * chain.channels(tap));
            EXPECT_EQ(samples[tap].back(), static_cast<double>(next - 1));
        }
        producer.pop();
        producer.wait_for_block(MonotonicClock::now() + std::chrono::seconds(60));
    }
    EXPECT_EQ(next, 1000);
}

/// Returns the last processor that this process may use.
int last_processor() {
    cpu_set_t allowed;
    EXPECT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
    int last = CPU_SETSIZE - 1;
    while (last > 0 && !CPU_ISSET(static_cast<unsigned>(last), &allowed)) {
        --last;
    }
    return last;
}

TEST(Producer, TheSimulatingThreadStaysOnItsProcessor) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1000, OnOverrun::wait);
    const int wanted = last_processor();
    EXPECT_THAT(producer.start({.cpu = wanted}), testing::IsEmpty());
    cpu_set_t granted;
    ASSERT_EQ(sched_getaffinity(simulating_thread(), sizeof granted, &granted), 0);
    EXPECT_EQ(CPU_COUNT(&granted), 1);
    EXPECT_TRUE(CPU_ISSET(static_cast<unsigned>(wanted), &granted));
}

TEST(Producer, TheSimulatingThreadHasRealTimePriorityOrItIsToldWhyNot) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1000, OnOverrun::wait);
    producer.want(format.taps);
    const std::vector<std::string> refused = producer.start({.realtime_priority = true, .cpu = std::nullopt});
    const bool first = sched_getscheduler(simulating_thread()) == SCHED_FIFO;
    EXPECT_EQ(first, !testing::Matches(testing::Contains(HasSubstr("no real-time priority: ")))(refused));
    if (!sanitized) {  // sanitizers lock nothing, and do not say so
        const bool locked = status_of(simulating_thread(), "VmLck:") > 0;
        EXPECT_EQ(locked,
                  !testing::Matches(testing::Contains(HasSubstr("memory cannot be locked: ")))(refused));
    }
    ::munlockall();
    producer.go();
    EXPECT_EQ(drained(producer).size(), 100U);
}

TEST(Producer, WithoutThreadOptionsTheThreadIsAnOrdinaryOne) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1000, OnOverrun::wait);
    EXPECT_THAT(producer.start({}), testing::IsEmpty());
    EXPECT_EQ(sched_getscheduler(simulating_thread()), SCHED_OTHER);
}

}  // namespace
}  // namespace hertzline::test
