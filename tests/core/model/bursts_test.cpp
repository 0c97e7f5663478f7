#include "core/model/bursts.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "hertzline/samples.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline {
namespace {

TEST(Bursts, AWholePeriodIsCountedToTheSample) {
    const Bursts bursts(1e7, 1000);
    EXPECT_EQ(bursts.at(0), (BurstPlace{0, 0}));
    EXPECT_EQ(bursts.at(9999), (BurstPlace{0, 9999}));
    EXPECT_EQ(bursts.at(10'000), (BurstPlace{1, 0}));
    EXPECT_EQ(bursts.at(10'000 * 86'400'000LL + 7), (BurstPlace{86'400'000, 7}));  // a day
}

TEST(Bursts, WithoutARepetitionThereIsOne) {
    const Bursts bursts(1e7, 0);
    EXPECT_FALSE(bursts.repeat());
    EXPECT_EQ(bursts.at(123'456'789), (BurstPlace{0, 123'456'789}));
}

TEST(Bursts, APeriodOfNoWholeNumberOfSamplesNeitherDriftsNorLosesASample) {
    const Bursts thirds(10, 3);  // periods of 10/3 samples: bursts begin at 0, 3.3, 6.7, 10
    EXPECT_EQ(thirds.first_sample(1), 4);
    EXPECT_EQ(thirds.first_sample(2), 7);
    EXPECT_EQ(thirds.first_sample(3), 10);
    for (const double repetition : {3.0, 0.7, 997.0 / 1013, 9.99}) {
        const Bursts bursts(10, repetition);
        BurstPlace last{0, -1};
        for (std::int64_t sample = 0; sample < 20'000; ++sample) {
            const BurstPlace place = bursts.at(sample);
            const bool goes_on = place == BurstPlace{last.burst, last.sample + 1};
            ASSERT_TRUE(goes_on || place == (BurstPlace{last.burst + 1, 0})) << repetition << ' ' << sample;
            // its time lies in the burst
            ASSERT_GE(static_cast<double>(sample) / 10 - static_cast<double>(place.burst) / repetition,
                      -1e-9);
            ASSERT_LT(static_cast<double>(sample) / 10 - static_cast<double>(place.burst + 1) / repetition,
                      1e-9);
            last = place;
        }
    }
}

TEST(Bursts, BeginWhereTheHornBegins) {
    Scene scene;
    scene.drive.envelope = Envelope::rectangular;  // moves at once
    scene.drive.cycles = 10;
    scene.drive.repetition_hz = 3001;  // 3332.2 samples
    scene.numerics.integrator = Integrator::taylor8;
    scene.numerics.step_s = 5e-7;
    Simulation simulation(scene, {.taps = Tap::v_horn});
    constexpr std::size_t samples = 20'000;
    Samples block = simulation.make_samples(samples);
    ASSERT_EQ(simulation.advance(block, samples), Status::running);
    const auto horn = block[Tap::v_horn];
    const Bursts bursts(scene.output.sample_rate_hz, scene.drive.repetition_hz);
    for (std::int64_t burst = 1; burst <= 6; ++burst) {
        const auto first = static_cast<std::size_t>(bursts.first_sample(burst));
        EXPECT_EQ(horn[first - 1], 0) << burst;
        EXPECT_GT(horn[first], 0) << burst;
    }
}

TEST(Bursts, SoManyThatNoCounterHoldsThemAreNoHarm) {
    EXPECT_EQ(Bursts(1e-3, 1e9).at(std::int64_t{1} << 50).sample, 0);
}

}  // namespace
}  // namespace hertzline
