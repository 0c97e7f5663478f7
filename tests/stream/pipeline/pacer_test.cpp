#include "stream/pipeline/pacer.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hertzline {

using namespace stream;
namespace {

using std::chrono::milliseconds;

constexpr auto always = [] { return true; };

/// A clock on which time passes only by sleeping.
struct FakeClock {
    Nanoseconds time{0};
    std::vector<Nanoseconds> naps;
    Nanoseconds now() const { return time; }
    void sleep_until(Nanoseconds until) {
        naps.push_back(until - time);
        time = until;
    }
};

TEST(Pacer, MapsSamplesToTimeFromTheStart) {
    Pacer pacer(10e6, Pace::realtime());
    pacer.start(Nanoseconds(5000));
    EXPECT_EQ(pacer.due(0), Nanoseconds(5000));
    EXPECT_EQ(pacer.due(1), Nanoseconds(5100));
    EXPECT_EQ(pacer.due(1024), Nanoseconds(5000 + 102400));
}

TEST(Pacer, TwiceTheFactorIsHalfTheTime) {
    EXPECT_EQ(Pacer(10e6, 2.0).due(1000), Nanoseconds(50'000));
    EXPECT_EQ(Pacer(10e6, 0.5).due(1000), Nanoseconds(200'000));
}

TEST(Pacer, DoesNotDriftInElevenDaysOfRunning) {
    const std::uint64_t samples = 10'000'000'000'000;
    EXPECT_EQ(Pacer(10e6, 1.0).due(samples), Nanoseconds(1'000'000'000'000'000));
    EXPECT_EQ(Pacer(10e6, 1.0).due(samples + 1), Nanoseconds(1'000'000'000'000'100));
    // Rates whose period is no whole number of nanoseconds, where adding up rounded periods would be far off.
    EXPECT_EQ(Pacer(3e6, 1.0).due(samples), Nanoseconds(3'333'333'333'333'333));
    EXPECT_EQ(Pacer(44100, 1.0).due(44100ULL * 3600 * 24 * 365), std::chrono::hours(24 * 365));
    EXPECT_EQ(Pacer(7e6, 1.0).due(7 * samples), Nanoseconds(10'000'000'000'000'000));
}

TEST(Pacer, IsExactForRatesThatAreNoWholeNumber) {
    // rate = 0.75 Hz exactly: 3e9 samples take 4e9 s.
    EXPECT_EQ(Pacer(1.5, 0.5).due(3'000'000'000), std::chrono::seconds(4'000'000'000));
    // A rate that no double holds: right to the double's own precision, here 1e-16 of 11 days.
    const auto due = Pacer(10e6, 0.3).due(3'000'000'000'000);
    EXPECT_NEAR(static_cast<double>((due - std::chrono::seconds(1'000'000)).count()), 0.0, 1.0);
}

TEST(Pacer, DeadlinesNeverGoBack) {
    const Pacer pacer(12'345'678.9, 0.987);
    for (const std::uint64_t base : {std::uint64_t{0}, std::uint64_t{10'000'000'000'000}}) {
        for (std::uint64_t i = 0; i < 1000; ++i) {
            const auto step = pacer.due(base + i + 1) - pacer.due(base + i);
            EXPECT_GE(step, Nanoseconds(82));  // 82.06 ns
            EXPECT_LE(step, Nanoseconds(83));
        }
    }
}

TEST(Pacer, SaturatesWhereTimeEnds) {
    const auto last = Nanoseconds::max();
    const auto most = std::numeric_limits<std::uint64_t>::max();
    EXPECT_EQ(Pacer(1.0, 1.0).due(most), last);
    EXPECT_EQ(Pacer(1e-300, 1e-6).due(1), last);
    Pacer late(1.0, 1.0);
    late.start(last - Nanoseconds(10));
    EXPECT_EQ(late.due(1), last);
    EXPECT_LT(Pacer(1e12, 1e6).due(most), last);
}

TEST(Pacer, LatenessIsPositiveOnlyAfterTheDeadline) {
    const Pacer pacer(10e6, 1.0);
    EXPECT_EQ(pacer.lateness(Nanoseconds(900), 10), Nanoseconds(-100));
    EXPECT_EQ(pacer.lateness(Nanoseconds(1000), 10), Nanoseconds(0));
    EXPECT_EQ(pacer.lateness(Nanoseconds(1250), 10), Nanoseconds(250));
}

TEST(Pacer, FlatOutIsNeverLateAndNeverWaits) {
    Pacer pacer(10e6, Pace::flat_out());
    pacer.start(Nanoseconds(100));
    FakeClock clock{.time = Nanoseconds(50), .naps = {}};
    EXPECT_EQ(wait_until_due(clock, pacer, 1'000'000, always), Nanoseconds(0));
    EXPECT_EQ(pacer.due(1'000'000), Nanoseconds(100));
    EXPECT_EQ(pacer.lateness(Nanoseconds(1'000'000), 5), Nanoseconds(0));
    EXPECT_TRUE(clock.naps.empty());
}

TEST(Pacer, RefusesSampleRatesThatGiveNoTime) {
    for (const double rate : {0.0, -1.0, std::nan(""), HUGE_VAL, 1.1e12}) {
        EXPECT_THROW(Pacer(rate, Pace::realtime()), std::invalid_argument) << rate;
    }
}

TEST(WaitUntilDue, SleepsUntilTheDeadlineAndNotLonger) {
    Pacer pacer(1000, 1.0);
    FakeClock clock;
    EXPECT_EQ(wait_until_due(clock, pacer, 20, always), -Nanoseconds(milliseconds(20)));
    EXPECT_EQ(clock.time, milliseconds(20));
    EXPECT_EQ(clock.naps.size(), 1u);
    EXPECT_EQ(wait_until_due(clock, pacer, 15, always), Nanoseconds(milliseconds(5)));
    EXPECT_EQ(clock.naps.size(), 1u);
}

TEST(WaitUntilDue, WakesOftenEnoughToBeStopped) {
    Pacer pacer(1, 1.0);
    FakeClock clock;
    int asked = 0;
    wait_until_due(clock, pacer, 3600, [&asked] { return ++asked <= 3; });
    EXPECT_EQ(clock.naps.size(), 3u);
    EXPECT_LE(clock.time, milliseconds(150));
}

TEST(MonotonicClock, SleepsUntilTheTimeHasCome) {
    MonotonicClock clock;
    const Nanoseconds until = MonotonicClock::now() + milliseconds(2);
    Pacer pacer(1000, 1.0);
    pacer.start(until - milliseconds(2));
    wait_until_due(clock, pacer, 2, always);
    EXPECT_GE(MonotonicClock::now(), until);
    MonotonicClock::sleep_until(until - std::chrono::hours(1));  // the past: returns at once
}

TEST(Pace, ReadsEveryAllowedText) {
    EXPECT_EQ(*parse_pace("realtime"), Pace::realtime());
    EXPECT_EQ(*parse_pace("flat-out"), Pace::flat_out());
    EXPECT_EQ(*parse_pace("0.25"), Pace::factor(0.25));
    EXPECT_EQ(*parse_pace("1e-6"), Pace::factor(1e-6));
    EXPECT_EQ(*parse_pace("1"), Pace::realtime());
}

TEST(Pace, NamesWhatWasFoundAndWhatIsAllowed) {
    for (const std::string text : {"", "fast", "0", "-1", "nan", "inf", "1e400", "1e-400", "1e7", "2x", " 2",
                                   "0x2", "+1", "Realtime", "flat_out"}) {
        const auto pace = parse_pace(text);
        ASSERT_FALSE(pace) << text;
        EXPECT_NE(pace.error().find("\"" + text + "\""), std::string::npos) << pace.error();
        EXPECT_NE(pace.error().find("realtime, flat-out or a number from"), std::string::npos);
    }
}

TEST(Pace, RefusesFactorsOutOfRange) {
    for (const double times : {0.0, -1.0, 1e-7, 1e7, std::nan("")}) {
        EXPECT_THROW(Pace::factor(times), std::invalid_argument) << times;
    }
}

}  // namespace
}  // namespace hertzline
