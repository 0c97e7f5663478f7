#include "stream/wire/continuity.hpp"

#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hertzline {

using namespace stream;
namespace {

using testing::HasSubstr;

constexpr std::uint64_t frame_samples = 100;

/// Frame number seq of a stream whose frames all have 100 samples.
FrameHeader frame(std::uint64_t seq, std::uint64_t dropped = 0, const char* run = "a") {
    return {.stream = "v_out",
            .unit = "m/s",
            .seq = seq,
            .sample = seq * frame_samples,
            .fs = 1e7,
            .dropped = dropped,
            .run = run,
            .n = frame_samples,
            .channels = 1};
}

TEST(ContinuityCheck, AnUnbrokenStreamMissesNothing) {
    ContinuityCheck check;
    EXPECT_EQ(check.take(frame(0)), Arrival::joined);
    for (std::uint64_t seq = 1; seq < 1000; ++seq) {
        EXPECT_EQ(check.take(frame(seq)), Arrival::in_order);
    }
    EXPECT_EQ(check.totals(), (ContinuityTotals{.frames = 1000, .samples = 100'000, .runs = 1}));
    EXPECT_TRUE(check.gapless());
    EXPECT_EQ(check.text(), "1000 frames, 100000 samples, nothing missing");
}

TEST(ContinuityCheck, JoiningMidRunIsNoLoss) {
    ContinuityCheck check;
    EXPECT_EQ(check.take(frame(5000, 17)), Arrival::joined);
    EXPECT_EQ(check.take(frame(5001, 17)), Arrival::in_order);
    EXPECT_TRUE(check.gapless());
}

TEST(ContinuityCheck, AGapThatDroppedExplainsIsTheSenders) {
    ContinuityCheck check;
    check.take(frame(0, 3));
    EXPECT_EQ(check.take(frame(5, 7)), Arrival::gap);
    EXPECT_EQ(check.totals().dropped_by_sender, 4u);
    EXPECT_EQ(check.totals().lost_on_the_way, 0u);
    EXPECT_EQ(check.totals().missing_samples, 400u);
    EXPECT_FALSE(check.gapless());
}

TEST(ContinuityCheck, AGapThatDroppedDoesNotExplainWasLostOnTheWay) {
    ContinuityCheck check;
    check.take(frame(0));
    EXPECT_EQ(check.take(frame(3)), Arrival::gap);
    EXPECT_EQ(check.totals().lost_on_the_way, 2u);
    EXPECT_EQ(check.totals().dropped_by_sender, 0u);
    EXPECT_EQ(check.take(frame(8, 1)), Arrival::gap);  // four missing, one of them dropped
    EXPECT_EQ(check.totals().lost_on_the_way, 2u + 3u);
    EXPECT_EQ(check.totals().dropped_by_sender, 1u);
    EXPECT_EQ(check.take(frame(9, 1)), Arrival::in_order);
    EXPECT_EQ(check.totals().missing_samples, 600u);
    EXPECT_EQ(check.text(),
              "4 frames, 400 samples, 600 samples missing, 1 frames dropped by the sender, "
              "5 frames lost on the way");
}

TEST(ContinuityCheck, ANewRunCountsAnew) {
    ContinuityCheck check;
    check.take(frame(100, 5));
    EXPECT_EQ(check.take(frame(0, 0, "b")), Arrival::new_run);
    EXPECT_EQ(check.take(frame(1, 0, "b")), Arrival::in_order);
    EXPECT_EQ(check.totals().runs, 2u);
    EXPECT_EQ(check.totals().frames, 3u);
    EXPECT_TRUE(check.gapless());
    EXPECT_THAT(check.text(), HasSubstr("2 runs"));
}

TEST(ContinuityCheck, RepeatedAndLateFramesDoNotMoveIt) {
    ContinuityCheck check;
    check.take(frame(10));
    check.take(frame(11));
    EXPECT_EQ(check.take(frame(11)), Arrival::repeated);
    EXPECT_EQ(check.take(frame(4)), Arrival::out_of_order);
    EXPECT_EQ(check.take(frame(12)), Arrival::in_order);
    EXPECT_EQ(check.totals(),
              (ContinuityTotals{.frames = 3, .samples = 300, .runs = 1, .repeated = 1, .out_of_order = 1}));
    EXPECT_FALSE(check.gapless());
}

TEST(ContinuityCheck, SamplesMissingWithoutAMissingFrameAreAGap) {
    ContinuityCheck check;
    check.take(frame(0));
    FrameHeader next = frame(1);
    next.sample += 250;
    EXPECT_EQ(check.take(next), Arrival::gap);
    EXPECT_EQ(check.totals().missing_samples, 250u);
    EXPECT_EQ(check.totals().lost_on_the_way, 0u);
}

TEST(ContinuityCheck, SamplesThatContradictTheFrameNumberAreInconsistent) {
    ContinuityCheck check;
    check.take(frame(0));
    FrameHeader overlapping = frame(1);
    overlapping.sample -= 1;
    EXPECT_EQ(check.take(overlapping), Arrival::inconsistent);
    FrameHeader crowded = frame(5);  // three frames are missing, but room is for two samples
    crowded.sample = frame_samples + 2;
    EXPECT_EQ(check.take(crowded), Arrival::inconsistent);
    EXPECT_EQ(check.totals().inconsistent, 2u);
    EXPECT_EQ(check.totals().frames, 1u);
    EXPECT_FALSE(check.gapless());
}

TEST(ContinuityCheck, FramesAfterAnInconsistentOneCountFromTheLastGoodOne) {
    ContinuityCheck check;
    check.take(frame(10));
    FrameHeader back = frame(11);
    back.sample = 0;
    check.take(back);
    FrameHeader after = frame(12);
    after.sample = frame_samples;  // follows the odd one
    EXPECT_EQ(check.take(after), Arrival::inconsistent);
    EXPECT_EQ(check.take(frame(13)), Arrival::gap);
    EXPECT_EQ(check.totals().missing_samples, 200u);
}

TEST(ContinuityCheck, FramesMayChangeTheirLength) {
    ContinuityCheck check;
    FrameHeader first = frame(0);
    first.n = 40;
    check.take(first);
    FrameHeader second = frame(1);
    second.sample = 40;
    EXPECT_EQ(check.take(second), Arrival::in_order);
    EXPECT_TRUE(check.gapless());
}

}  // namespace
}  // namespace hertzline
