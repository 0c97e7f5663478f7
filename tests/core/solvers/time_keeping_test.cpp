// Time is computed from counters, not summed: after 1e10 steps of the clock a sample is at its exact time.

#include <cmath>

#include <gtest/gtest.h>

#include "core/integrators/stability.hpp"
#include "core/model/tone_burst.hpp"
#include "core/solvers/fixed_time.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {
namespace {

constexpr std::int64_t many = 10'000'000'000;

TEST(TimeKeeping, SampleTenThousandMillionLiesWhereItWasMeantToBe) {
    // the moment of sample k in steps, k/(rate h), by numbers of 64 bits; FixedTime has 64 behind the point
    for (const double steps : {3.3, 0.7, 1 / 0.3, 12.345678901234567}) {
        const FixedTime period = FixedTime::of(steps);
        const FixedTime last = period.times(many);
        const long double meant = static_cast<long double>(steps) * many;
        EXPECT_EQ(last.whole, static_cast<std::int64_t>(meant)) << steps;
        const auto fraction = static_cast<double>(meant - std::floor(meant));
        EXPECT_NEAR(last.fraction(), fraction, 1e-8) << steps;  // the digits of long double behind the point
    }
}

TEST(TimeKeeping, AddingThePeriodAgainAndAgainIsExact) {
    constexpr std::int64_t count = 100'000'000;
    const FixedTime period = FixedTime::of(1 / 0.3);
    FixedTime at;
    for (std::int64_t i = 0; i < count; ++i) {
        at.advance(period);
    }
    EXPECT_EQ(at.whole, period.times(count).whole);
    EXPECT_EQ(at.part, period.times(count).part);
    // strides from there are exact, too: 1e10 periods in a hundred of them
    FixedTime far;
    for (int i = 0; i < 100; ++i) {
        far.advance(at);
    }
    EXPECT_EQ(far.whole, period.times(many).whole);
    EXPECT_EQ(far.part, period.times(many).part);
}

TEST(TimeKeeping, ABurstAfterTenThousandMillionStepsBeginsWhenItShould) {
    Drive drive;
    drive.cycles = 5;
    drive.repetition_hz = 8192;
    const double step = 0x1p-23;  // 1024 steps from burst to burst, of which 1e10 is a multiple
    const ToneBurst burst(drive, step);
    for (const std::int64_t at : {std::int64_t{0}, many}) {
        const SmoothDrive begins = burst.smooth(at, 0);
        EXPECT_NE(begins.amplitude_m[0], 0) << at;
        EXPECT_NEAR(begins.since_burst_s, 0, 1e-9 * step) << at;
        const double quarter = 1 / (4 * drive.frequency_hz * step);
        const HornMotion early = burst.at(0, 4 * quarter);
        const HornMotion late = burst.at(at, 4 * quarter);
        EXPECT_NEAR(late.v, early.v, 1e-9 * std::abs(early.v)) << at;
    }
}

TEST(TimeKeeping, SeriesCountSamplesHoweverLongTheyGoOn) {
    // a chain that nothing disturbs, pieces of more than a thousand samples that divide nothing
    constexpr std::int64_t far = repeated(many);
    for (const Integrator integrator : series_integrators()) {
        Scene scene;
        scene.drive.amplitude_m = 0;
        scene.output.sample_rate_hz = 1e9;
        const Chain chain(scene);
        const double step = largest_stable_step(chain, chain.static_overlap, integrator);
        Simulation simulation(with_step(scene, integrator, step));
        ASSERT_EQ(simulation.skip(far), Status::running);
        EXPECT_EQ(simulation.next_sample(), far);
        // the present piece holds the last sample: it began at most a step before
        const double last_s = static_cast<double>(far - 1) / scene.output.sample_rate_hz;
        EXPECT_GE(simulation.time_s(), last_s);
        EXPECT_LE(simulation.time_s(), last_s + step);
        Samples part = simulation.make_samples(10);
        ASSERT_EQ(simulation.advance(part, 10), Status::running);
        EXPECT_EQ(part.first, far);
    }
}

}  // namespace
}  // namespace hertzline::test
