// The horn's motion as a function of time, against the model's formula in more digits.

#include "core/model/tone_burst.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace hertzline::test {
namespace {

constexpr double step_s = 50e-9;

std::vector<Drive> drives() {
    std::vector<Drive> all;
    for (const Envelope envelope : {Envelope::hann, Envelope::tukey, Envelope::rectangular}) {
        for (const double cycles : {25.0, 10.3, 1.0, 0.25}) {
            for (const double repetition_hz : {0.0, 1000.0, 2919.7}) {
                Drive drive;
                drive.envelope = envelope;
                drive.cycles = cycles;
                drive.repetition_hz = repetition_hz;
                drive.taper = 0.3;  // a ramp that does not fit the burst a whole number of times
                all.push_back(drive);
            }
        }
    }
    Drive touching;  // one burst follows the other without a pause
    touching.repetition_hz = touching.frequency_hz / touching.cycles;
    all.push_back(touching);
    return all;
}

/// Returns x_h(t) = A e(t) sin(2 pi f t) (docs/model.md, section 5), t since the burst's start, in extended precision.
long double displacement(const Drive& drive, long double t) {
    const long double pi = std::numbers::pi_v<long double>;
    const long double duration = static_cast<long double>(drive.cycles) / drive.frequency_hz;
    if (t <= 0 || t >= duration) {
        return 0;
    }
    long double envelope = 1;
    if (drive.envelope == Envelope::hann) {
        envelope = (1 - std::cos(2 * pi * t / duration)) / 2;
    } else if (drive.envelope == Envelope::tukey) {
        const long double rise = drive.taper * duration / 2;
        const long double from_edge = std::min(t, duration - t);
        envelope = from_edge < rise ? (1 - std::cos(pi * from_edge / rise)) / 2 : 1;
    }
    return drive.amplitude_m * envelope * std::sin(2 * pi * drive.frequency_hz * t);
}

long double since_burst(const Drive& drive, long double t) {
    if (drive.repetition_hz == 0) {
        return t;
    }
    const long double period = 1 / static_cast<long double>(drive.repetition_hz);
    return t - std::floor(t / period) * period;
}

TEST(ToneBurst, MovesAsTheFormulaSays) {
    for (const Drive& drive : drives()) {
        const ToneBurst burst(drive, step_s);
        for (std::int64_t step = 0; step < 60'000; step += 7) {
            const long double t = (step + 0.37L) * step_s;
            EXPECT_NEAR(burst.at(step, 0.37).x / drive.amplitude_m,
                        static_cast<double>(displacement(drive, since_burst(drive, t)) / drive.amplitude_m),
                        3e-12)
                << step;
        }
    }
}

TEST(ToneBurst, VelocityAndAccelerationAreItsDerivatives) {
    const double d = 0.001;  // [steps]
    for (const Drive& drive : drives()) {
        const ToneBurst burst(drive, step_s);
        const double omega = 2 * std::numbers::pi * drive.frequency_hz;
        for (std::int64_t step = 1; step < 30'000; step += 11) {
            const HornMotion before = burst.at(step, 0.5 - d, 0.5);
            const HornMotion now = burst.at(step, 0.5);
            const HornMotion after = burst.at(step, 0.5 + d, 0.5);
            const double v = (after.x - before.x) / (2 * d * step_s);
            const double a = (after.v - before.v) / (2 * d * step_s);
            EXPECT_NEAR(v / (omega * drive.amplitude_m), now.v / (omega * drive.amplitude_m), 1e-5);
            EXPECT_NEAR(a / (omega * omega * drive.amplitude_m), now.a / (omega * omega * drive.amplitude_m),
                        1e-4);
        }
    }
}

void expect_close(const HornMotion& found, const HornMotion& expected, const Drive& drive, double bound) {
    const double omega = 2 * std::numbers::pi * drive.frequency_hz;
    const double scale = drive.amplitude_m;
    ASSERT_NEAR(found.x / scale, expected.x / scale, bound);
    ASSERT_NEAR(found.v / (omega * scale), expected.v / (omega * scale), bound);
    // the shortest ramp (tukey, a quarter of a cycle) curves 1600 times as much as the carrier
    ASSERT_NEAR(found.a / (omega * omega * scale), expected.a / (omega * omega * scale), 2000 * bound);
}

TEST(ToneBurst, TablesGiveTheSameAsTheFormulaEverywhere) {
    constexpr int batch = ToneBurst::batch_steps;
    for (const Drive& drive : drives()) {
        ToneBurst burst(drive, step_s);
        std::array<HornStep, batch> steps{};
        for (std::int64_t first = 0; first < 60'000; first += batch) {
            const bool rests = burst.fill(first, steps.data(), batch);
            for (int i = 0; i < batch; ++i) {
                expect_close(steps[i].start, burst.at(first + i, 0, 0.5), drive, 1e-12);
                expect_close(steps[i].end, burst.at(first + i, 1, 0.5), drive, 1e-12);
                EXPECT_EQ(steps[i].breaks, burst.next_break(first + i, 0) < 1);
                if (!steps[i].breaks) {
                    expect_close(steps[i].middle, burst.at(first + i, 0.5), drive, 1e-12);
                }
                if (rests) {
                    EXPECT_EQ(steps[i].start.x, 0);
                    EXPECT_EQ(steps[i].middle.v, 0);
                }
            }
        }
    }
}

TEST(ToneBurst, BreaksLieWherePiecesOfTheEnvelopeMeet) {
    for (const Drive& drive : drives()) {
        const ToneBurst burst(drive, step_s);
        std::vector<double> expected;
        const double duration = drive.cycles / drive.frequency_hz;
        const double rise = drive.taper * duration / 2;
        const double period = drive.repetition_hz > 0 ? 1 / drive.repetition_hz : 1;
        for (double start = 0; start < 1.2e-3; start += period) {
            if (drive.envelope == Envelope::tukey) {
                expected.insert(expected.end(), {start + rise, start + duration - rise});
            }
            expected.push_back(start + duration);
            if (start + period > start + duration * (1 + 1e-9)) {
                expected.push_back(start + period);
            }
        }
        std::vector<double> found;
        for (std::int64_t step = 0; step < 24'000; ++step) {
            for (double at = burst.next_break(step, 0); at < 1; at = burst.next_break(step, at)) {
                found.push_back((static_cast<double>(step) + at) * step_s);
            }
        }
        std::erase_if(expected, [](double t) {  // those at a step's edge are no breaks inside a step
            const double steps = t / step_s;
            return t >= 1.2e-3 - 1e-15 || std::abs(steps - std::round(steps)) < 1e-8;
        });
        ASSERT_EQ(found.size(), expected.size()) << drive.cycles << ' ' << drive.repetition_hz;
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i], expected[i], 1e-17 + 1e-13 * expected[i]);
        }
    }
}

TEST(ToneBurst, AStepThatHoldsABreakIsMarked) {
    Drive drive;
    drive.envelope = Envelope::rectangular;  // it stops at full speed
    ToneBurst burst(drive, step_s);
    std::array<HornStep, 64> steps{};
    const std::int64_t last = 25 * 10'000'000 / 73'000 * 2;  // 50 ns steps in 25 cycles
    const std::int64_t first = last / 64 * 64;
    burst.fill(first, steps.data(), 64);
    const auto broken = std::find_if(steps.begin(), steps.end(), [](const HornStep& s) { return s.breaks; });
    ASSERT_NE(broken, steps.end());
    EXPECT_TRUE(broken->fresh);
    const std::int64_t step = first + (broken - steps.begin());
    const double burst_s = drive.cycles / drive.frequency_hz;
    EXPECT_NEAR((static_cast<double>(step) + burst.next_break(step, 0)) * step_s, burst_s, 1e-12 * burst_s);
}

TEST(ToneBurst, NeitherDriftsNorForgetsAfterManyHours) {
    // 1e10 steps of 1/3 us are an hour; both the step and the period are no whole numbers in binary
    Drive drive;
    drive.repetition_hz = 1234.5;
    constexpr double step = 1e-6 / 3;
    const ToneBurst burst(drive, step);
    double largest = 0;
    for (const std::int64_t n : {10'000'000'000LL, 10'000'012'345LL, 12'345'678'901LL}) {
        for (std::int64_t i = n; i < n + 3000; ++i) {
            const long double t = static_cast<long double>(i) * step;
            const auto expected = static_cast<double>(displacement(drive, since_burst(drive, t)));
            largest = std::max(largest, std::abs(burst.at(i, 0).x - expected) / drive.amplitude_m);
        }
    }
    EXPECT_LE(largest, 3e-9);  // an error of 1e-16 s would be 5e-11, of the reference itself 1e-16 of an hour
}

TEST(ToneBurst, RepeatsItselfToRoundingWhereStepsFitThePeriod) {
    Drive drive;
    drive.repetition_hz = 1000;
    const ToneBurst burst(drive, step_s);
    for (const std::int64_t later : {20'000LL, 20'000'000LL, 20'000'000'000LL}) {
        // the step as a binary number is off by up to 1e-16 of itself, which adds up
        const double bound =
            1e-12 + 2e-16 * 2 * std::numbers::pi * 73e3 * static_cast<double>(later) * step_s;
        for (std::int64_t i = 0; i < 8000; i += 3) {
            expect_close(burst.at(later + i, 0.5), burst.at(i, 0.5), drive, bound);
        }
    }
}

TEST(ToneBurst, RestsBetweenBurstsAndBeforeTheFirst) {
    Drive drive;
    drive.repetition_hz = 1000;
    const ToneBurst burst(drive, step_s);
    for (std::int64_t step = 6850; step < 20'000; ++step) {  // 342.5 us to 1 ms
        const HornMotion horn = burst.at(step, 0);
        EXPECT_TRUE(horn.x == 0 && horn.v == 0 && horn.a == 0) << step;
    }
    EXPECT_EQ(burst.at(0, 0).x, 0);
    EXPECT_EQ(burst.at(0, 0).v, 0);
    EXPECT_NE(burst.at(20'001, 0).v, 0);
}

}  // namespace
}  // namespace hertzline::test
