// The simulating thread's half of a stream, with a source that costs nothing.

#include "stream/pipeline/producer.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/counting_source.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

constexpr std::size_t slots = 4;
constexpr RingSize four{.blocks = slots};
constexpr StreamFormat format{
    .taps = TapSet(Tap::v_out), .spheres = 1, .sample_rate_hz = 1e6, .frame_samples = 10};

/// A clock that has run for a day: whatever is produced comes too late.
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

/// Takes all blocks there will be.
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
    wait_for(producer);  // nobody reads
    EXPECT_EQ(producer.dropped(), 100 - slots);
    EXPECT_EQ(drained(producer).size(), slots);
    EXPECT_EQ(source.next_sample(), 1000);
}

TEST(Producer, NumbersGoOnPastWhatWasDiscarded) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1'000'000, OnOverrun::drop);
    producer.want(format.taps);
    producer.start({});
    producer.go();
    while (producer.dropped() < 10) {
        MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::microseconds(100));
    }
    const std::vector<Block> blocks = drained(producer);
    ASSERT_GT(blocks.size(), slots);
    EXPECT_GE(blocks[slots].dropped, 10U);
    for (const Block& block : blocks) {
        EXPECT_EQ(block.samples().first, static_cast<std::int64_t>(block.seq) * format.frame_samples);
        EXPECT_EQ(block.samples()[Tap::v_out][0], static_cast<double>(block.samples().first));
    }
    EXPECT_EQ(blocks.size() + producer.dropped(), 100'000U);
}

TEST(Producer, WaitsRatherThanDiscardWhenToldSo) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1000, OnOverrun::wait);
    producer.start({});
    producer.go();
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

/// How often the simulating thread of this process has gone to sleep.
long sleeps_of_the_simulating_thread() {
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
        std::ifstream status(task.path() / "status");
        std::string name;
        std::string key;
        for (status >> key >> name; name == simulating_thread_name && status >> key;) {
            if (long count = 0; key == "voluntary_ctxt_switches:" && status >> count) {
                return count;
            }
        }
    }
    ADD_FAILURE() << "no such thread";
    return 0;
}

TEST(Producer, SleepsWhileTheRingIsFullAndFillsItAgainWhenAQuarterIsFree) {
    constexpr std::size_t many = 64;
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, {.blocks = many}, std::nullopt, OnOverrun::wait);
    producer.start({});
    producer.go();
    const auto full = [&] { return producer.ring().size() == many; };
    ASSERT_TRUE(eventually(full));
    MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::milliseconds(10));
    const long before = sleeps_of_the_simulating_thread();
    MonotonicClock::sleep_until(MonotonicClock::now() + std::chrono::milliseconds(100));
    EXPECT_EQ(sleeps_of_the_simulating_thread(), before) << "it wakes up although nothing has changed";
    for (std::size_t taken = 0; taken < many / 4; ++taken) {
        EXPECT_LT(producer.ring().size(), many + 1 - taken);
        ASSERT_NE(producer.front(), nullptr);
        producer.pop();
    }
    EXPECT_TRUE(eventually(full));
}

TEST(Producer, HasRoomOfItsOwnForBlocksWithEverySphere) {
    const StreamFormat chain{
        .taps = TapSet(Tap::v_out) | Tap::v_chain, .spheres = 3, .sample_rate_hz = 1e6, .frame_samples = 10};
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

TEST(Producer, TellsWhichThreadOptionsTheSystemRefusesAndGoesOn) {
    CountingSource source(format);
    const Pacer pacer = long_ago();
    Producer producer(source, pacer, four, 1000, OnOverrun::wait);
    producer.want(format.taps);
    // granted or not, by whoever runs the tests
    for (const std::string& refused : producer.start({.realtime_priority = true, .cpu = 0})) {
        EXPECT_GT(refused.size(), 20U);
    }
    producer.go();
    EXPECT_EQ(drained(producer).size(), 100U);
}

}  // namespace
}  // namespace hertzline::test
