#include "core/model/live_motion.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/model/drive.hpp"
#include "core/model/sampled_motion.hpp"
#include "tests/support/records.hpp"

namespace hertzline::test {
namespace {

constexpr double record_s = 400e-6;

/// A record as float32 holds it.
Drive rounded(Drive drive) {
    for (double& sample : drive.samples) {
        sample = static_cast<double>(static_cast<float>(sample));
    }
    return drive;
}

/// The motion of samples that come in such portions.
std::unique_ptr<LiveMotion> live_motion(const Drive& drive, std::size_t portion) {
    auto motion = std::make_unique<LiveMotion>(drive, 2 * record_s);
    const std::vector<float> samples(drive.samples.begin(), drive.samples.end());
    for (std::size_t i = 0; i < samples.size(); i += portion) {
        EXPECT_TRUE(motion->has_room());
        motion->append(std::span(samples).subspan(i, std::min(portion, samples.size() - i)));
    }
    return motion;
}

struct RateCase {
    double rate_hz;
    DriveQuantity quantity;
};

TEST(LiveMotion, IsThatOfTheRecordToTheLastBitHoweverItIsCut) {
    for (const auto& [rate, quantity] : {RateCase{10e6, DriveQuantity::displacement},
                                         {10e6, DriveQuantity::velocity},
                                         {1e6, DriveQuantity::displacement},
                                         {35e6, DriveQuantity::displacement},
                                         {35e6, DriveQuantity::velocity}}) {
        const Drive drive = rounded(
            sampled(quantity == DriveQuantity::velocity ? SmoothBurst::velocity : SmoothBurst::displacement,
                    rate, record_s, quantity));
        const SampledMotion record(drive);
        ASSERT_FALSE(record.facts().drift_removed);
        for (const std::size_t portion : {1, 7, 64, 1000, 1024}) {
            const auto live = live_motion(drive, portion);
            const double known_s = live->known_until_s();
            ASSERT_GT(known_s, record_s / 4) << rate;
            EXPECT_LE(record_s - known_s,
                      static_cast<double>(Reconstruction::lookahead(rate, lowpass_hz(drive)) + 2) / rate);
            for (double time_s = 0; time_s < known_s; time_s += 0.37e-6) {
                const Polynomial& here = live->at(time_s);
                const Polynomial& there = record.at(time_s);
                ASSERT_EQ(here.terms, there.terms)
                    << time_s << " of portions of " << portion << " at " << rate;
                ASSERT_EQ(here.end_s, there.end_s);
            }
            EXPECT_FALSE(live->overtaken());
        }
    }
}

TEST(LiveMotion, KeepsADriftAsItsRecordDoes) {
    Drive drive = sampled(SmoothBurst::velocity, 10e6, record_s, DriveQuantity::velocity);
    for (double& sample : drive.samples) {
        sample += 14e-3;
    }
    drive = rounded(drive);
    EXPECT_TRUE(SampledMotion(drive).facts().drift_removed);
    drive.kind = DriveKind::live;
    const SampledMotion record(drive);
    EXPECT_FALSE(record.facts().drift_removed);
    const auto live = live_motion(drive, 1000);
    const double time_s = record_s / 2;
    EXPECT_EQ(record.at(time_s).terms, live->at(time_s).terms);
    EXPECT_GT(live->at(time_s).at(time_s).x, 0.9 * 14e-3 * time_s);
}

TEST(LiveMotion, TellsThatItWasAskedForWhatHasNotCome) {
    const auto live = live_motion(sampled(SmoothBurst::displacement, 10e6, record_s), 1000);
    live->at(live->known_until_s());
    EXPECT_TRUE(live->overtaken());
}

TEST(LiveMotion, HasRoomAgainForWhatIsGivenBack) {
    const Drive drive = sampled(SmoothBurst::displacement, 10e6, record_s);
    LiveMotion live(drive, 10e-6);
    const std::vector<float> portion(LiveMotion::portion);
    int portions = 0;
    while (live.has_room()) {
        live.append(portion);
        ASSERT_LT(++portions, 10'000);
    }
    live.release(live.known_until_s() - 1e-6);
    EXPECT_TRUE(live.has_room());
    EXPECT_EQ(live.at(live.known_until_s() - 0.5e-6).at(0).x, 0);
    EXPECT_FALSE(live.overtaken());
}

TEST(LiveMotion, CountsDisplacementsFromTheFirstSampleAndScales) {
    Drive drive = sampled(SmoothBurst::displacement, 10e6, record_s);
    const auto plain = live_motion(drive, 1000);
    for (double& sample : drive.samples) {
        sample = sample * 0x1p20 + 4;
    }
    drive.scale = 0x1p-20;
    const auto scaled = live_motion(drive, 1000);
    for (double time_s = 0; time_s < 200e-6; time_s += 1e-6) {
        EXPECT_NEAR(scaled->at(time_s).at(time_s).x, plain->at(time_s).at(time_s).x, 1e-6 * 3e-6 + 0x1p-42);
    }
}

}  // namespace
}  // namespace hertzline::test
