// A horn that is a resonator, on which the chain acts back: against an independent solver and closed forms.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/energy.hpp"
#include "hertzline/resolve.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/records.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

Scene resonator(double mass_kg) {
    Scene scene;
    scene.drive.horn = HornModel::resonator;
    scene.drive.horn_frequency_hz = 74e3;
    scene.drive.horn_quality = 30;
    scene.drive.horn_mass_kg = mass_kg;
    scene.numerics.integrator = Integrator::taylor12;
    scene.numerics.step_s = 0.3e-6;
    return scene;
}

std::vector<double> run_of(const Scene& scene, Tap tap, std::size_t samples = 4000) {
    Simulation simulation(settled(scene), {.taps = tap});
    Samples block = simulation.make_samples(samples);
    if (simulation.advance(block, samples) != Status::running) {
        throw std::runtime_error(simulation.failure());
    }
    return {block[tap].begin(), block[tap].end()};
}

TEST(HornResonator, TheAccuracyAskedForIsKeptAndEstimated) {
    constexpr double reference_is_good_to = 1e-9;
    const Reference reference = read_reference("mixed/horn_resonator");
    Scene scene = random_reference_scene("mixed/horn_resonator");
    for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8}) {
        scene.numerics.accuracy = accuracy;
        const Resolution settled = resolve(scene);
        const Comparison errors = compare_with_reference(settled.scene, reference);
        const double error = std::max({errors.v_last, errors.v_plate, errors.v_out});
        EXPECT_LE(error, accuracy) << accuracy;
        EXPECT_LE(errors.energy_residual, std::max(10 * accuracy, 1e-8)) << accuracy;
        ASSERT_TRUE(settled.estimate.has_value());
        EXPECT_GE(2 * settled.estimate->error + reference_is_good_to, error) << accuracy;
        EXPECT_LE(settled.estimate->error, 3 * std::max(error, reference_is_good_to)) << accuracy;
    }
}

TEST(HornResonator, WithoutReactionItIsTheClosedForm) {
    Scene scene = resonator(0);
    scene.drive.envelope = Envelope::rectangular;
    scene.drive.cycles = 1000;  // beyond the run
    const std::vector<double> x = run_of(scene, Tap::x_horn);
    // u'' + (w/Q) u' + w^2 u = w^2 G A sin(W t) from rest: steady state, and what the free resonator takes from it
    const double w = 2 * std::numbers::pi * *scene.drive.horn_frequency_hz;
    const double drive = 2 * std::numbers::pi * scene.drive.frequency_hz;
    const double half = w / scene.drive.horn_quality / 2;
    const double damped = std::sqrt(w * w - half * half);
    const double amplitude = scene.drive.amplitude_m;
    const double phase = std::arg(std::complex(w * w - drive * drive, 2 * half * drive));
    const auto steady = [&](double t) { return amplitude * std::sin(drive * t - phase); };
    const double x0 = -steady(0);
    const double v0 = -amplitude * drive * std::cos(phase);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double t = static_cast<double>(i) / scene.output.sample_rate_hz;
        const double free = std::exp(-half * t) *
                            (x0 * std::cos(damped * t) + (v0 + half * x0) / damped * std::sin(damped * t));
        ASSERT_NEAR(x[i], steady(t) + free, 1e-10 * amplitude) << i;
    }
}

TEST(HornResonator, AHeavyOneMovesAsARecordOfItself) {
    const Scene heavy = resonator(1e4);
    Scene recorded = heavy;
    recorded.output.sample_rate_hz = 20e6;
    const std::vector<double> x = run_of(recorded, Tap::x_horn, 8001);
    recorded = heavy;
    recorded.drive =
        sampled([&](double t) { return x[static_cast<std::size_t>(std::llround(t * 20e6))]; }, 20e6, 400e-6);
    EXPECT_LE(relative_l2(run_of(recorded, Tap::v_last), run_of(heavy, Tap::v_last)), 2e-8);
    EXPECT_LE(relative_l2(run_of(heavy, Tap::v_last), run_of(resonator(0), Tap::v_last)), 1e-6)
        << "no mass stands for an infinite one";
}

TEST(HornResonator, ARecordIsItsFreeMotion) {
    Scene scene = resonator(0);
    scene.drive = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    const std::vector<double> prescribed = run_of(scene, Tap::v_last);
    scene.drive.horn = HornModel::resonator;
    scene.drive.horn_frequency_hz = 74e3;
    EXPECT_LE(relative_l2(run_of(scene, Tap::v_last), prescribed), 1e-8) << "where nothing acts back";
    scene.drive.horn_mass_kg = 1e-3;
    EXPECT_GE(relative_l2(run_of(scene, Tap::v_last), prescribed), 1e-3);
}

TEST(HornResonator, TheNoiseOfARecordIsNotDifferentiated) {
    std::mt19937 generator(1);
    std::normal_distribution<double> noise(0, 1e-9);
    Scene scene;
    scene.drive =
        sampled([&](double t) { return SmoothBurst::displacement(t) + (t > 0 ? noise(generator) : 0); }, 10e6,
                400e-6);
    scene.output.duration_s = 400e-6;
    const std::vector<double> x = run_of(scene, Tap::x_horn);
    const std::vector<double> v = run_of(scene, Tap::v_last);
    scene.drive.horn = HornModel::resonator;
    scene.drive.horn_quality = 50;
    EXPECT_LE(relative_l2(run_of(scene, Tap::x_horn), x), 1e-12);
    EXPECT_LE(relative_l2(run_of(scene, Tap::v_last), v), 1e-3);
    scene.drive.horn_mass_kg = 1e-3;
    const Resolution resolved = resolve(scene);
    ASSERT_TRUE(resolved.estimate.has_value());
    EXPECT_LE(resolved.estimate->error, 1e-4);
    Simulation simulation(resolved.scene, {.taps = Tap::x_horn});
    EXPECT_EQ(simulation.skip(4000), Status::running);
    const Ledger ledger = simulation.ledger();
    const double missing = ledger.source_work - ledger.horn_lost - ledger.horn_held - ledger.work;
    EXPECT_NEAR(missing / ledger.work, 0, 0.02) << "but for the work of the preload";
}

class StiffHorn : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Masses, StiffHorn, ::testing::Values(0.0, 1e-6));

TEST_P(StiffHorn, ShortensThePieces) {
    Scene scene = resonator(GetParam());
    scene.drive.horn_frequency_hz = 3e6;
    scene.numerics = {};
    scene.numerics.accuracy = 1e-5;
    const Resolution resolved = resolve(scene);
    ASSERT_TRUE(resolved.faults.empty());
    ASSERT_TRUE(resolved.estimate.has_value());
    EXPECT_LE(resolved.estimate->error, 1e-5);
    Scene finer = resolved.scene;
    finer.numerics.step_s = *finer.numerics.step_s / 4;
    for (const Tap tap : {Tap::v_last, Tap::v_horn}) {
        EXPECT_LE(relative_l2(run_of(resolved.scene, tap), run_of(finer, tap)), 2e-5);
    }
}

/// Light horns, and chains whose contacts all begin to touch, included.
TEST(HornResonator, ItsEnergyIsAccountedFor) {
    for (const double mass_kg : {3e-6, 1e-4, 1e-2}) {
        for (const double preload_n : {0.1, 0.0}) {
            Scene scene = resonator(mass_kg);
            scene.chain.preload_n = preload_n;
            Simulation simulation(settled(scene), {.taps = Tap::x_horn});
            Samples block = simulation.make_samples(4000);
            ASSERT_EQ(simulation.advance(block, 4000), Status::running);
            const Ledger ledger = simulation.ledger();
            EXPECT_LE(simulation.energy_residual(), 1e-7) << mass_kg << " " << preload_n;
            // the tip's work on the chain, less that of the preload, which its place of rest balances; the ledger's place is that of the
            // last piece's end, up to 0.3 us later than the last sample's
            const double preload_work = preload_n * block[Tap::x_horn][3999];
            const double missing =
                ledger.source_work - ledger.horn_lost - ledger.horn_held - (ledger.work - preload_work);
            EXPECT_NEAR(missing / ledger.source_work, 0, preload_n > 0 ? 1e-4 : 1e-9)
                << mass_kg << " " << preload_n;
            EXPECT_GT(ledger.horn_lost, 0);
        }
    }
}

TEST(HornResonator, TheForceOnTheHornMovesIt) {
    const Scene scene = resonator(1e-4);
    const std::vector<double> x = run_of(scene, Tap::x_horn);
    const std::vector<double> f = run_of(scene, Tap::f_first);
    const std::vector<double> v = run_of(scene, Tap::v_horn);
    const double h = 1 / scene.output.sample_rate_hz;
    const double w = 2 * std::numbers::pi * *scene.drive.horn_frequency_hz;
    const std::size_t after = 3600;  // the burst is over: r = 0
    for (std::size_t i = after; i + 2 < x.size(); ++i) {
        const double a = (8 * (v[i + 1] - v[i - 1]) - (v[i + 2] - v[i - 2])) / (12 * h);
        const double expected = -w / scene.drive.horn_quality * v[i] - w * w * x[i] -
                                (f[i] - scene.chain.preload_n) / scene.drive.horn_mass_kg;
        ASSERT_NEAR(a, expected, 1e-3 * w * w * scene.drive.amplitude_m) << i;
    }
    EXPECT_NEAR(f.front(), scene.chain.preload_n, 1e-15);
}

TEST(HornResonator, TheFreeTipHasItsPeak) {
    Drive drive;
    drive.horn = HornModel::resonator;
    drive.envelope = Envelope::rectangular;
    drive.horn_quality = 100;
    drive.cycles = 40;
    // at resonance the amplitude grows as 1 - exp(-w t/(2 Q)), to first order in 1/Q
    const double grown = 1 - std::exp(-std::numbers::pi * drive.cycles / drive.horn_quality);
    const double omega = 2 * std::numbers::pi * drive.frequency_hz;
    ASSERT_TRUE(tip_peak(drive));
    EXPECT_NEAR(tip_peak(drive)->x / drive.amplitude_m, grown, 0.01);
    EXPECT_NEAR(tip_peak(drive)->v / (omega * drive.amplitude_m), grown, 0.01);
    EXPECT_EQ(largest_velocity(drive), omega * drive.amplitude_m) << "of the steady state";
    drive.horn_quality = 2;
    EXPECT_NEAR(tip_peak(drive)->x / drive.amplitude_m, 1, 0.01);
    // a sweep passes the resonance, while the amplitude is that at 60 kHz
    drive.horn_quality = 100;
    drive.envelope = Envelope::hann;
    drive.cycles = 100;
    drive.horn_frequency_hz = drive.frequency_hz;
    drive.frequency_hz = 60e3;
    drive.sweep_to_hz = 86e3;
    const double peak = tip_peak(drive)->x;
    EXPECT_NEAR(peak / drive.amplitude_m, 14.7, 0.1);  // of an independent integration
    EXPECT_GT(largest_velocity(drive), 10 * omega * drive.amplitude_m);
    drive.start_s = 1e-3;
    drive.repetition_hz = 100;
    EXPECT_EQ(tip_peak(drive)->x, peak);
    drive.cycles = 1e6;
    EXPECT_FALSE(tip_peak(drive));
    drive.horn = HornModel::prescribed;
    EXPECT_FALSE(tip_peak(drive));
}

TEST(HornResonator, GridsRefuseIt) {
    Scene scene = resonator(1e-3);
    scene.numerics.integrator = Integrator::leapfrog;
    const std::vector<Fault> faults = validate(scene);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_THAT(
        faults.front().message(),
        testing::HasSubstr("numerics.integrator: found \"leapfrog\" with drive.horn = \"resonator\""));
    scene.drive.kind = DriveKind::none;
    EXPECT_TRUE(validate(scene).empty()) << "there is no horn";
}

TEST(FirstContact, ItsForceIsThatOfTheChainsFirst) {
    for (const Integrator integrator : choices<Integrator>) {
        Scene scene = with_step(Scene{}, integrator, 50e-9);
        Simulation simulation(scene, {.taps = TapSet(Tap::f_first) | Tap::f_chain});
        Samples block = simulation.make_samples(2000);
        ASSERT_EQ(simulation.advance(block, 2000), Status::running);
        Simulation alone(scene, {.taps = Tap::f_first});
        Samples other = alone.make_samples(77);
        for (std::size_t i = 0; i < 1000; ++i) {
            ASSERT_EQ(block[Tap::f_first][i], block[Tap::f_chain][7 * i]) << word(integrator);
        }
        ASSERT_EQ(alone.advance(other, 77), Status::running);
        EXPECT_TRUE(std::ranges::equal(other[Tap::f_first], block[Tap::f_first].first(77)));
    }
}

}  // namespace
}  // namespace hertzline::test
