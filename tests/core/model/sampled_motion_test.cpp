#include "core/model/sampled_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/drive.hpp"
#include "core/model/sampled_horn.hpp"
#include "tests/support/records.hpp"

namespace hertzline::test {
namespace {

constexpr double fine_s = 0.037e-6;

HornMotion motion_at(const Drive& drive, double time_s) {
    return SampledHorn(drive, 1, SampledMotion::of(drive)).at(0, time_s);
}

/// Largest errors of displacement and velocity between the samples, relative to the largest values.
struct Errors {
    double x = 0;
    double v = 0;
};

template <class Displacement, class Velocity>
Errors errors(const Drive& drive, const Displacement& displacement, const Velocity& velocity,
              double until_s) {
    const SampledHorn horn(drive, fine_s, SampledMotion::of(drive));
    Errors found;
    double largest_x = 0;
    double largest_v = 0;
    for (std::int64_t i = 0; static_cast<double>(i) * fine_s < until_s; ++i) {
        const double t = static_cast<double>(i) * fine_s;
        const HornMotion now = horn.at(i, 0);
        found.x = std::max(found.x, std::abs(now.x - displacement(t)));
        found.v = std::max(found.v, std::abs(now.v - velocity(t)));
        largest_x = std::max(largest_x, std::abs(displacement(t)));
        largest_v = std::max(largest_v, std::abs(velocity(t)));
    }
    return {found.x / largest_x, found.v / largest_v};
}

TEST(SampledMotion, IsTheMotionBetweenTheSamples) {
    struct Rate {
        double hz;
        double bound;
    };
    // by the spline's error, 2 (f T)^8 and so on: docs/model.md
    for (const Rate rate : {Rate{10e6, 2e-11}, Rate{2e6, 2e-10}, Rate{1e6, 2e-7}}) {
        const Drive x = sampled(SmoothBurst::displacement, rate.hz, 400e-6);
        const Drive v = sampled(SmoothBurst::velocity, rate.hz, 400e-6, DriveQuantity::velocity);
        for (const Drive& drive : {x, v}) {
            const Errors found = errors(drive, SmoothBurst::displacement, SmoothBurst::velocity, 400e-6);
            EXPECT_LE(found.x, rate.bound) << rate.hz;
            EXPECT_LE(found.v, 10 * rate.bound) << rate.hz;
        }
    }
}

TEST(SampledMotion, AccelerationAndSeriesAreThoseOfTheMotion) {
    const Drive drive = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    const SampledHorn horn(drive, fine_s, SampledMotion::of(drive));
    constexpr double unit_s = 0.9e-6;
    for (std::int64_t step = 4000; step < 7000; step += 17) {
        const double h = 1e-9 / fine_s;
        const double slope = (horn.at(step, h).v - horn.at(step, -h).v) / 2e-9;
        EXPECT_NEAR(horn.at(step, 0).a, slope, 1e-6 * std::pow(SmoothBurst::omega, 2) * 3e-6);
        const SmoothDrive piece = horn.smooth(step, 0);
        ASSERT_NE(piece.polynomial, nullptr);
        std::array<double, 16> terms{};
        horn.series(piece, 0, unit_s, terms);
        const double z = std::min(1.0, piece.left_s / unit_s);
        double x = 0;
        for (std::size_t n = terms.size(); n-- > 0;) {
            x = x * z + terms[n];
        }
        EXPECT_NEAR(x, horn.at(step, z * unit_s / fine_s * (1 - 1e-12)).x, 1e-17);
        EXPECT_NEAR(terms[1], horn.at(step, 0).v * unit_s, 1e-17);
    }
}

TEST(SampledMotion, ItsPiecesContinueEachOther) {
    const Drive drive = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    const auto motion = SampledMotion::of(drive);
    ASSERT_GT(motion->pieces().size(), 20U);
    EXPECT_LT(motion->pieces().size(), 250U) << "every piece ends one of the solver's";
    for (std::size_t i = 1; i + 1 < motion->pieces().size(); ++i) {
        const Polynomial& before = motion->pieces()[i - 1];
        const Polynomial& after = motion->pieces()[i];
        const double end_s = before.middle_s + before.half_s;
        EXPECT_NEAR(end_s, after.middle_s - after.half_s, 1e-18);
        EXPECT_NEAR(motion_at(drive, end_s * (1 - 1e-15)).x, motion_at(drive, end_s).x, 1e-17);
    }
}

TEST(SampledMotion, OfARecordThatIsShorterThanTheLowPassItsShareIsKnown) {
    Drive drive = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    drive.lowpass_hz = 40e3;  // below the burst
    EXPECT_GT(SampledMotion::of(drive)->facts().beyond_share, 1);
}

TEST(SampledMotion, TheLowPassTakesWhatLiesAboveAndLeavesTheRestInPlace) {
    const auto beyond = [](double t) {
        return SmoothBurst::envelope(t) / 10 * std::sin(2 * std::numbers::pi * 1.6e6 * t);
    };
    Drive drive = sampled([&](double t) { return SmoothBurst::displacement(t) + beyond(t); }, 10e6, 400e-6);
    EXPECT_LE(errors(drive, SmoothBurst::displacement, SmoothBurst::velocity, 400e-6).x, 1e-10);
    EXPECT_NEAR(SampledMotion::of(drive)->facts().beyond_share, 0.1, 0.002);
    drive.lowpass_hz = 2e6;  // which leaves it
    EXPECT_GE(errors(drive, SmoothBurst::displacement, SmoothBurst::velocity, 400e-6).x, 0.05);
    EXPECT_LE(SampledMotion::of(drive)->facts().beyond_share, 1e-8);
}

TEST(SampledMotion, NoiseIsTold) {
    constexpr double noise_m = 1e-9;
    std::mt19937 generator(1);
    std::normal_distribution<double> noise(0, noise_m);
    const Drive drive =
        sampled([&](double t) { return SmoothBurst::displacement(t) + (t > 0 ? noise(generator) : 0); }, 10e6,
                400e-6);
    const RecordFacts& facts = SampledMotion::of(drive)->facts();
    EXPECT_NEAR(facts.noise, noise_m, 0.1 * noise_m);
    // 2 pi S^(1/2) (f^3/3)^(1/2) with S = noise^2 in 5 MHz, f = 1.25 MHz, where the low-pass of 1 MHz leaves half
    EXPECT_NEAR(facts.noise_velocity, 2 * std::numbers::pi * 1.25e6 * noise_m * std::sqrt(1.25 / 15), 2e-4);
    // it is about the one that the resting horn has
    double squares = 0;
    constexpr int moments = 1000;
    for (int i = 0; i < moments; ++i) {
        const double v = SampledMotion::of(drive)->at(320e-6 + i * 50e-9).at(320e-6 + i * 50e-9).v;
        squares += v * v / moments;
    }
    EXPECT_NEAR(facts.noise_velocity, std::sqrt(squares), 0.15 * facts.noise_velocity);
}

TEST(SampledMotion, NoiseOfAShortRecordIsTold) {
    std::mt19937 generator(1);
    std::normal_distribution<double> noise(0, 25e-9);
    const auto with_noise = [&](double t) {
        return SmoothBurst::displacement(t) + (t > 0 ? noise(generator) : 0);
    };
    Drive drive = sampled(with_noise, 10e6, 160e-6);
    drive.lowpass_hz = 200e3;
    EXPECT_NEAR(SampledMotion::of(drive)->facts().noise, 25e-9, 5e-9);
}

TEST(SampledMotion, ARecordThatIsCutHasNoMoreNoise) {
    const Drive cut = sampled(SmoothBurst::velocity, 10e6, 203e-6, DriveQuantity::velocity);
    EXPECT_LE(SampledMotion::of(cut)->facts().noise, 1e-8);
    EXPECT_GE(SampledMotion::of(cut)->facts().end_share, 0.5);
}

TEST(SampledMotion, CountsFromTheFirstSampleAndScales) {
    Drive drive = sampled([](double t) { return 7 + 1e6 * SmoothBurst::displacement(t); }, 10e6, 400e-6);
    drive.scale = 1e-6;
    EXPECT_LE(errors(drive, SmoothBurst::displacement, SmoothBurst::velocity, 400e-6).x, 1e-8);
    EXPECT_NEAR(SampledMotion::of(drive)->facts().offset, 7e-6, 1e-12);
}

TEST(SampledMotion, ADriftIsRemovedAndAStepIsNot) {
    constexpr double drift = 2e-3;  // [m/s]
    const Drive drifting =
        sampled([](double t) { return SmoothBurst::displacement(t) + drift * t; }, 10e6, 400e-6);
    const Drive offset = sampled([](double t) { return SmoothBurst::velocity(t) + drift; }, 10e6, 400e-6,
                                 DriveQuantity::velocity);
    for (const Drive& drive : {drifting, offset}) {
        EXPECT_TRUE(SampledMotion::of(drive)->facts().drift_removed);
        EXPECT_NEAR(SampledMotion::of(drive)->facts().drift_m_per_s, drift, 1e-5);
        EXPECT_LE(errors(drive, SmoothBurst::displacement, SmoothBurst::velocity, 400e-6).x, 1e-3);
    }
    const auto step = [](double t) { return 1e-6 * (1 + std::erf((t - 200e-6) / 10e-6)); };
    const Drive stepping = sampled(step, 10e6, 400e-6);
    EXPECT_FALSE(SampledMotion::of(stepping)->facts().drift_removed);
    EXPECT_NEAR(motion_at(stepping, 390e-6).x, 2e-6, 1e-15);
    EXPECT_NEAR(motion_at(stepping, 1).x, 2e-6, 1e-15) << "it stays there";
    EXPECT_EQ(motion_at(stepping, 1).v, 0);
    // a record that is cut while the horn rings has a mean velocity, too, but no drift
    const Drive cut = sampled(SmoothBurst::velocity, 10e6, 203e-6, DriveQuantity::velocity);
    EXPECT_FALSE(SampledMotion::of(cut)->facts().drift_removed);
}

TEST(SampledMotion, RestsBeforeAndAfterAndRepeats) {
    Drive drive = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    drive.start_s = 100e-6;
    drive.repetition_hz = 2000;
    SampledHorn horn(drive, 1e-6, SampledMotion::of(drive));
    EXPECT_EQ(horn.at(50, 0).x, 0);
    for (const std::int64_t burst : {0, 1, 12345}) {
        for (const double t : {180e-6, 201e-6, 230e-6}) {
            const std::int64_t step = 100 + 500 * burst;
            EXPECT_NEAR(horn.at(step, t * 1e6).x, SmoothBurst::displacement(t), 1e-15) << burst;
        }
    }
    std::array<HornStep, Horn::batch_steps> steps;
    EXPECT_TRUE(horn.fill(0, steps.data(), Horn::batch_steps));
    EXPECT_FALSE(horn.fill(256, steps.data(), Horn::batch_steps));
    EXPECT_EQ(steps[3].start.x, horn.at(259, 0).x);
    EXPECT_EQ(steps[3].middle.v, horn.at(259, 0.5).v);
    EXPECT_EQ(steps[3].end.a, horn.at(260, 0).a);
}

TEST(SampledMotion, EqualDrivesShareOne) {
    const Drive drive = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    Drive other = drive;
    other.start_s = 1;
    EXPECT_EQ(SampledMotion::of(drive), SampledMotion::of(other));
    other.scale = 2;
    EXPECT_NE(SampledMotion::of(drive), SampledMotion::of(other));
}

std::string fault_of(const Drive& drive) {
    const std::vector<Fault> faults = drive_faults(drive);
    return faults.empty() ? "" : faults.front().message();
}

TEST(DriveFaults, NameRecordsThatDriveNoHorn) {
    using testing::HasSubstr;
    const Drive good = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    EXPECT_EQ(fault_of(good), "");
    Drive drive = sampled([](double t) { return SmoothBurst::displacement(t + 180e-6); }, 10e6, 200e-6);
    EXPECT_THAT(fault_of(drive), HasSubstr("begins amid a motion"));
    drive = sampled([](double t) { return SmoothBurst::velocity(t + 180e-6); }, 10e6, 200e-6,
                    DriveQuantity::velocity);
    EXPECT_THAT(fault_of(drive), HasSubstr("begins amid a motion"));
    drive = good;
    drive.repetition_hz = 2600;
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.repetition_hz: found 2600, allowed: at most 2500 Hz"));
    drive = sampled([](double t) { return 1e-6 * (1 + std::erf((t - 200e-6) / 10e-6)); }, 10e6, 400e-6);
    EXPECT_EQ(fault_of(drive), "");
    drive.repetition_hz = 100;
    EXPECT_THAT(fault_of(drive), HasSubstr("the record ends 100 % of its largest displacement away"));
    drive = good;
    drive.repetition_hz = 2000;
    drive.start_s = 100e-6;
    EXPECT_EQ(fault_of(drive), "");
    drive.start_s = 101e-6;
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.start_s: found 0.000101, allowed: at most"));
    drive = good;
    drive.scale = 4e5;
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.samples: found a largest displacement of 1."));
    drive = good;
    drive.lowpass_hz = 4e6;
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.lowpass_hz: found 4e+06, allowed: 1000 to 3333333 Hz"));
    drive.lowpass_hz = 900;
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.lowpass_hz: found 900"));
    drive = good;
    drive.file = "horn.csv";
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.file: found \"horn.csv\" beside drive.samples"));
    drive = good;
    drive.column = "x_m";
    EXPECT_THAT(fault_of(drive),
                HasSubstr("drive.column: found \"x_m\", allowed: none beside drive.samples"));
    drive = good;
    drive.sample_rate_hz.reset();
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.sample_rate_hz: found nothing"));
    drive.samples.clear();
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.file: found nothing"));
    drive.file = "horn.csv";
    EXPECT_THAT(fault_of(drive), HasSubstr("drive.file: found \"horn.csv\", which was not read"));
}

TEST(DriveFaults, NoiseAtRestIsNoMotion) {
    std::mt19937 generator(1);
    for (const double noise_m : {1e-9, 3e-9, 1e-8}) {
        std::normal_distribution<double> noise(0, noise_m);
        for (int record = 0; record < 20; ++record) {
            EXPECT_EQ(
                fault_of(sampled([&](double t) { return SmoothBurst::displacement(t) + noise(generator); },
                                 5e6, 400e-6)),
                "")
                << noise_m;
        }
    }
}

TEST(DriveFaults, ASilentRecordIsNone) {
    EXPECT_EQ(fault_of(sampled([](double) { return 0; }, 10e6, 400e-6)), "");
    EXPECT_EQ(fault_of(sampled([](double) { return 4e-6; }, 10e6, 400e-6)), "");
    EXPECT_EQ(motion_at(sampled([](double) { return 4e-6; }, 10e6, 400e-6), 1e-4).x, 0);
}

}  // namespace
}  // namespace hertzline::test
