#include "stream/pipeline/load_shedder.hpp"

#include <gtest/gtest.h>

namespace hertzline::test {

using namespace stream;
namespace {

using namespace std::chrono_literals;

constexpr TapSet all_taps = TapSet(Tap::v_out) | Tap::v_last | Tap::v_chain | Tap::f_chain;

/// A stream that is judged once a period, at times of its own.
class Judged {
public:
    TapSet judge(Nanoseconds lateness, std::uint64_t dropped = 0, TapSet taken = all_taps) {
        now_ += LoadShedder::period;
        shedder_.judge(taken, lateness, dropped, now_);
        return shedder_.shed();
    }
    TapSet judge_for(Nanoseconds time, Nanoseconds lateness) {
        for (const Nanoseconds end = now_ + time; now_ < end;) {
            judge(lateness);
        }
        return shedder_.shed();
    }
    void overload() { judge_for(10 * LoadShedder::period, 40ms); }

private:
    LoadShedder shedder_{{.taps = all_taps,
                          .counts = {.spheres = 6, .points = 2},
                          .sample_rate_hz = 1e7,
                          .frame_samples = 1024}};
    Nanoseconds now_{0};
};

TEST(LoadShedder, ShedsTheLargestFirstAndLeavesOne) {
    Judged stream;
    EXPECT_EQ(stream.judge(26ms), TapSet());
    EXPECT_EQ(stream.judge(27ms), TapSet(Tap::f_chain)) << "a contact more than spheres";
    EXPECT_EQ(stream.judge(28ms), TapSet(Tap::f_chain) | Tap::v_chain);
    EXPECT_EQ(stream.judge(29ms), TapSet(Tap::f_chain) | Tap::v_chain | Tap::v_last);
    EXPECT_EQ(stream.judge(30ms), TapSet(Tap::f_chain) | Tap::v_chain | Tap::v_last);
}

TEST(LoadShedder, ShedsNothingOfAStreamThatIsInTimeOrWasHeldUpAndCatchesUp) {
    Judged stream;
    EXPECT_EQ(stream.judge_for(10s, 24ms), TapSet());
    std::uint64_t dropped = 0;
    for (Nanoseconds lateness = 500ms; lateness > 0ms; lateness -= 5ms) {
        EXPECT_EQ(stream.judge(lateness, ++dropped), TapSet());
    }
}

TEST(LoadShedder, WhoDiscardsBlocksIsBehindHoweverShortItsRingIs) {
    Judged stream;
    stream.judge(1ms, 1);
    EXPECT_EQ(stream.judge(1ms, 2), TapSet(Tap::f_chain));
    EXPECT_EQ(stream.judge(1ms, 2), TapSet(Tap::f_chain));
}

TEST(LoadShedder, LooksAtTheStreamOnceAPeriod) {
    LoadShedder shedder({.taps = all_taps,
                         .counts = {.spheres = 6, .points = 2},
                         .sample_rate_hz = 1e7,
                         .frame_samples = 1024});
    for (int i = 0; i < 100; ++i) {
        shedder.judge(all_taps, 40ms, 0, 1s + i * 10us);
    }
    EXPECT_EQ(shedder.shed(), TapSet());
}

TEST(LoadShedder, WhatWasShedComesBackAndRestsTwiceAsLongWhenThatWasInVain) {
    Judged stream;
    for (const Nanoseconds rest : {1s, 2s, 4s, 8s, 16s, 32s, 60s, 60s}) {
        stream.overload();
        EXPECT_NE(stream.judge_for(rest - 100ms, 0ms), TapSet());
        EXPECT_EQ(stream.judge_for(200ms, 0ms), TapSet());
    }
    stream.judge_for(61s, 0ms);
    stream.overload();
    EXPECT_EQ(stream.judge_for(1s, 0ms), TapSet()) << "the overload before is long ago";
}

TEST(LoadShedder, SendsAllAgainWhereThatDoesNotHelp) {
    Judged stream;
    stream.overload();
    EXPECT_EQ(stream.judge(1001ms), TapSet());
    EXPECT_EQ(stream.judge_for(10s, 2s), TapSet());
    stream.judge(0ms);
    stream.overload();
    EXPECT_NE(stream.judge(40ms), TapSet()) << "it has been in time since";
}

TEST(LoadShedder, WhatNobodyTakesIsNotShed) {
    Judged stream;
    stream.overload();
    EXPECT_EQ(stream.judge(40ms, 0, Tap::v_out), TapSet());
    EXPECT_EQ(stream.judge(41ms, 0, Tap::v_out), TapSet());
}

}  // namespace
}  // namespace hertzline::test
