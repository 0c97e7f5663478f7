// A recording as the source of a stream.

#include "stream/inputs/replay_source.hpp"

#include <algorithm>
#include <deque>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;
namespace {

/// Reads given rows in pieces of at most 7, as a format might.
class ListReader : public RecordingReader {
public:
    ListReader(std::vector<Column> columns, std::deque<RecordedRows> pieces, bool damaged = false)
        : pieces_(std::move(pieces)), damaged_(damaged) {
        head_.columns = std::move(columns);
    }
    ListReader(RecordingHead head, std::deque<RecordedRows> pieces)
        : head_(std::move(head)), pieces_(std::move(pieces)), damaged_(false) {}
    const RecordingHead& head() const noexcept override { return head_; }
    bool read(RecordedRows& rows, std::size_t most) override {
        if (pieces_.empty()) {
            if (damaged_) {
                throw std::runtime_error("here.csv: damaged");
            }
            return false;
        }
        RecordedRows& piece = pieces_.front();
        const std::size_t width = head_.columns.size();
        const std::size_t count = std::min({most, piece.values.size() / width, std::size_t{7}});
        const auto end = piece.values.begin() + static_cast<std::ptrdiff_t>(count * width);
        rows.first = piece.first;
        rows.values.assign(piece.values.begin(), end);
        piece.values.erase(piece.values.begin(), end);
        piece.first += static_cast<std::int64_t>(count);
        if (piece.values.empty()) {
            pieces_.pop_front();
        }
        return true;
    }

private:
    RecordingHead head_;
    std::deque<RecordedRows> pieces_;
    bool damaged_;
};

/// Returns rows whose numbers are the sample's index, plus a tenth for each further column.
RecordedRows counted(std::int64_t first, std::int64_t count, std::size_t columns) {
    RecordedRows rows{.first = first, .values = {}};
    for (std::int64_t i = first; i < first + count; ++i) {
        for (std::size_t column = 0; column < columns; ++column) {
            rows.values.push_back(static_cast<double>(i) + 0.1 * static_cast<double>(column));
        }
    }
    return rows;
}

const std::vector<Column> outputs{{"v_last_m_per_s", "v_last", "m/s"},
                                  {"x1_m", "x_chain", "m"},
                                  {"v1_m_per_s", "v_chain", "m/s"},
                                  {"x2_m", "x_chain", "m"},
                                  {"v2_m_per_s", "v_chain", "m/s"}};

ReplaySource source(std::vector<Column> columns, std::deque<RecordedRows> pieces, bool damaged = false) {
    return {std::make_unique<ListReader>(std::move(columns), std::move(pieces), damaged), 1e6, 10};
}

TEST(ReplaySource, ColumnsBecomeTheStreamsOfTheirName) {
    ReplaySource replay = source(outputs, {counted(0, 25, 5)});
    EXPECT_EQ(replay.format().taps, TapSet(Tap::v_last) | Tap::v_chain);
    EXPECT_EQ(replay.format().counts.spheres, 2U);
    Samples samples = replay.make_block(replay.format().taps);
    ASSERT_TRUE(replay.read(samples, 10, replay.format().taps));
    EXPECT_EQ(samples.count, 10U);
    EXPECT_EQ(samples[Tap::v_last][9], 9.0);
    EXPECT_EQ(samples[Tap::v_chain][2 * 9], 9 + 0.1 * 2);
    EXPECT_EQ(samples[Tap::v_chain][2 * 9 + 1], 9 + 0.1 * 4);
}

TEST(ReplaySource, BurstsAreThoseOfTheRecordedScene) {
    const auto repetition_of_replay = [](const Json& provenance, double sample_rate_hz) {
        RecordingHead head{.columns = outputs, .sample_rate_hz = 1e6, .provenance = provenance};
        auto reader = std::make_unique<ListReader>(std::move(head), std::deque{counted(0, 25, 5)});
        return ReplaySource(std::move(reader), sample_rate_hz, 10).format().repetition_hz;
    };
    const Json scene{{"scene", {{"drive", {{"repetition_hz", 1000.0}}}}}};
    EXPECT_EQ(repetition_of_replay(scene, 1e6), 1000);
    EXPECT_EQ(repetition_of_replay(scene, 2e6), 2000);  // played faster
    EXPECT_EQ(repetition_of_replay({}, 1e6), 0);
}

TEST(ReplaySource, FramesAreFullUntilTheEnd) {
    ReplaySource replay = source(outputs, {counted(0, 25, 5)});
    Samples samples = replay.make_block(replay.format().taps);
    std::vector<std::size_t> counts;
    while (replay.read(samples, 10, replay.format().taps)) {
        counts.push_back(samples.count);
    }
    EXPECT_EQ(counts, (std::vector<std::size_t>{10, 10, 5}));
    EXPECT_EQ(replay.next_sample(), 25);
    EXPECT_EQ(replay.failure(), "");
}

TEST(ReplaySource, AFrameEndsAtAGapAndTheIndicesJump) {
    ReplaySource replay = source(outputs, {counted(100, 13, 5), counted(1000, 4, 5)});
    EXPECT_EQ(replay.next_sample(), 100);
    Samples samples = replay.make_block(replay.format().taps);
    std::vector<std::pair<std::int64_t, std::size_t>> frames;
    while (replay.read(samples, 10, replay.format().taps)) {
        frames.emplace_back(samples.first, samples.count);
        EXPECT_EQ(samples[Tap::v_last][samples.count - 1],
                  static_cast<double>(samples.first) + static_cast<double>(samples.count - 1));
    }
    EXPECT_EQ(frames, (std::vector<std::pair<std::int64_t, std::size_t>>{{100, 10}, {110, 3}, {1000, 4}}));
}

TEST(ReplaySource, TwoColumnsOfOneTapAreRefused) {
    for (const char* tap : {"v_out", "v_last", "v_horn", "f_last"}) {
        EXPECT_THROW(source({{"a", tap, ""}, {"b", tap, ""}}, {counted(0, 25, 2)}), std::runtime_error)
            << tap;
    }
}

TEST(ReplaySource, ForcesOfAllContactsAreOneMoreThanTheSpheres) {
    const Column v1{"v1_m_per_s", "v_chain", "m/s"};
    const Column f1{"f1_n", "f_chain", "N"};
    const Column f2{"f2_n", "f_chain", "N"};
    ReplaySource both = source({v1, f1, f2}, {counted(0, 25, 3)});
    EXPECT_EQ(both.format().counts.spheres, 1U);
    Samples samples = both.make_block(both.format().taps);
    ASSERT_TRUE(both.read(samples, 10, both.format().taps));
    EXPECT_EQ(samples[Tap::f_chain][2 * 9], 9 + 0.1 * 1);
    EXPECT_EQ(samples[Tap::f_chain][2 * 9 + 1], 9 + 0.1 * 2);
    EXPECT_EQ(source({f1, f2}, {counted(0, 25, 2)}).format().counts.spheres, 1U);
    EXPECT_THROW(source({v1, f1}, {counted(0, 25, 2)}), std::runtime_error) << "the end's contact is missing";
}

TEST(ReplaySource, PressuresAtPointsAreOneTap) {
    ReplaySource replay =
        source({{"p_1_pa", "p_points", "Pa"}, {"p_2_pa", "p_points", "kPa"}}, {counted(0, 25, 2)});
    EXPECT_EQ(replay.format().taps, TapSet(Tap::p_points));
    EXPECT_EQ(replay.format().channels(Tap::p_points), 2U);
    Samples samples = replay.make_block(Tap::p_points);
    ASSERT_TRUE(replay.read(samples, 10, Tap::p_points));
    EXPECT_EQ(samples[Tap::p_points][2 * 9], 9);
    EXPECT_EQ(samples[Tap::p_points][2 * 9 + 1], 1e3 * (9 + 0.1));
}

TEST(ReplaySource, WhatIsNotStreamedIsPassedOver) {
    ReplaySource replay =
        source({{"x1_m", "x_chain", "m"}, {"v_last_m_per_s", "v_last", "m/s"}}, {counted(0, 25, 2)});
    EXPECT_EQ(replay.format().taps, TapSet(Tap::v_last));
}

TEST(ReplaySource, SkippingGoesByTheIndexGapsIncluded) {
    ReplaySource replay = source(outputs, {counted(0, 13, 5), counted(50, 20, 5)});
    EXPECT_TRUE(replay.skip(12));
    EXPECT_EQ(replay.next_sample(), 12);
    EXPECT_TRUE(replay.skip(43));
    Samples samples = replay.make_block(replay.format().taps);
    ASSERT_TRUE(replay.read(samples, 10, replay.format().taps));
    EXPECT_EQ(samples.first, 55);
    EXPECT_EQ(samples[Tap::v_last][0], 55.0);
    EXPECT_FALSE(replay.skip(100));
}

TEST(ReplaySource, OneColumnOfSomebodyElseIsStreamedAsVOutAndSeveralAsVChain) {
    EXPECT_EQ(source({{"channel_1", "", ""}}, {counted(0, 5, 1)}).format().taps, TapSet(Tap::v_out));
    const ReplaySource three = source({{"a", "", ""}, {"b", "", ""}, {"c", "", ""}}, {counted(0, 5, 3)});
    EXPECT_EQ(three.format().taps, TapSet(Tap::v_chain));
    EXPECT_EQ(three.format().counts.spheres, 3U);
}

TEST(ReplaySource, NumbersComeInTheUnitOfTheStream) {
    ReplaySource replay =
        source({{"v_out", "v_out", "mm/s"}, {"f_last", "f_last", "kN"}}, {counted(0, 25, 2)});
    Samples samples = replay.make_block(replay.format().taps);
    ASSERT_TRUE(replay.read(samples, 10, replay.format().taps));
    EXPECT_DOUBLE_EQ(samples[Tap::v_out][9], 9e-3);
    EXPECT_DOUBLE_EQ(samples[Tap::f_last][9], 9.1e3);
    EXPECT_THAT(replay.warnings(), testing::IsEmpty());
}

TEST(ReplaySource, NumbersInAnotherUnitAreStreamedUnchangedWithAWarning) {
    ReplaySource replay = source({{"CH1", "CH1", "mV"}}, {counted(0, 25, 1)});
    Samples samples = replay.make_block(replay.format().taps);
    ASSERT_TRUE(replay.read(samples, 10, replay.format().taps));
    EXPECT_EQ(samples[Tap::v_out][9], 9);
    EXPECT_THAT(replay.warnings(),
                testing::ElementsAre("CH1 is in mV: its numbers are streamed unchanged as v_out in m/s"));
    EXPECT_THAT(source({{"CH1", "CH1", ""}}, {counted(0, 25, 1)}).warnings(), testing::IsEmpty())
        << "nothing is known of the unit";
}

TEST(ReplaySource, AnEmptyRecordingIsRefused) {
    EXPECT_THROW(source(outputs, {}), std::runtime_error);
}

TEST(ReplaySource, DamageEndsTheStreamWithItsReason) {
    ReplaySource replay = source(outputs, {counted(0, 13, 5)}, true);
    Samples samples = replay.make_block(replay.format().taps);
    EXPECT_TRUE(replay.read(samples, 10, replay.format().taps));
    EXPECT_TRUE(replay.read(samples, 10, replay.format().taps));
    EXPECT_EQ(samples.count, 3U);
    EXPECT_FALSE(replay.read(samples, 10, replay.format().taps));
    EXPECT_EQ(replay.failure(), "here.csv: damaged");
}

}  // namespace
}  // namespace hertzline::test
