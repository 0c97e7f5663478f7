// Horns that move as a record does: against an independent solver that knows the motion itself, and against tones.

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/resolve.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/records.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

const std::string folder = std::string(HERTZLINE_SOURCE_DIR) + "/tests/reference/mixed/";

struct HornFile {
    const char* name;
    double sample_rate_hz;
};

class SampledDrive : public ::testing::TestWithParam<HornFile> {
protected:
    SampledDrive() {
        scene_.drive = read_horn(folder + GetParam().name + ".csv", GetParam().sample_rate_hz);
        scene_.output.duration_s = 600e-6;
    }

    Scene scene_;
    Reference reference_ = read_reference("mixed/sampled_drive");
};

INSTANTIATE_TEST_SUITE_P(Rates, SampledDrive,
                         ::testing::Values(HornFile{"horn_10MHz", 10e6}, HornFile{"horn_2MHz", 2e6}),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST_P(SampledDrive, IsAsGoodAsTheMotionItself) {
    constexpr double reference_is_good_to = 6e-10;
    for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-9}) {
        scene_.numerics.accuracy = accuracy;
        const Resolution settled = resolve(scene_);
        ASSERT_TRUE(settled.faults.empty());
        const Comparison errors = compare_with_reference(settled.scene, reference_);
        const double error = std::max({errors.v_last, errors.v_plate, errors.v_out});
        EXPECT_LE(error, std::max(accuracy, 1e-9)) << accuracy;
        EXPECT_LE(errors.energy_residual, std::max(10 * accuracy, 1e-8)) << accuracy;
        ASSERT_TRUE(settled.estimate.has_value());
        EXPECT_GE(2 * settled.estimate->error + reference_is_good_to, error) << accuracy;
    }
}

TEST_P(SampledDrive, EveryMethodConvergesToIt) {
    for (const Integrator integrator : choices<Integrator>) {
        const Comparison errors = compare_with_reference(with_step(scene_, integrator, 34e-9), reference_);
        EXPECT_LE(errors.v_last, integrator == Integrator::leapfrog ? 2e-3 : 2e-5) << word(integrator);
        EXPECT_LE(errors.energy_residual, 1e-3) << word(integrator);
    }
}

TEST_P(SampledDrive, BlocksOfAnySizeGiveTheSameBits) {
    for (const Integrator integrator : choices<Integrator>) {
        const Scene scene = with_step(scene_, integrator, 50e-9);
        EXPECT_EQ(recorded(scene, 3000, 3000), recorded(scene, 3000, 77)) << word(integrator);
    }
}

TEST(SilentRecord, MovesNothing) {
    Scene scene;
    scene.drive = sampled([](double) { return 4e-6; }, 10e6, 100e-6);
    EXPECT_EQ(recorded(settled(scene), 2000).v_last, std::vector<double>(2000, 0.0));
}

TEST(RepeatedRecord, BeginsAgainEveryPeriod) {
    Scene scene;
    scene.drive = sampled(SmoothBurst::displacement, 10e6, 400e-6);
    scene.drive.repetition_hz = 1000 / 0.6;
    scene.drive.start_s = 33e-6;
    for (const Integrator integrator : choices<Integrator>) {
        Simulation simulation(with_step(scene, integrator, is_series(integrator) ? 0.6e-6 : 25e-9),
                              {.taps = everything});
        const Record run = recorded(simulation, 30'000, 1000);
        const auto burst = [&](std::size_t number) {
            const auto begin = run.v_last.begin() + static_cast<std::ptrdiff_t>(6000 * number);
            return std::vector(begin, begin + 6000);
        };
        EXPECT_LE(relative_l2(burst(4), burst(3)), 0.02) << word(integrator) << ": the ringing has settled";
        EXPECT_LE(simulation.energy_residual(), 1e-3) << word(integrator);
    }
}

/// The tone's own velocity, recorded at some rate.
Drive recorded_tone(Scene scene, double sample_rate_hz) {
    scene.output.sample_rate_hz = sample_rate_hz;
    Simulation simulation(settled(scene), {.taps = Tap::v_horn});
    Samples samples =
        simulation.make_samples(static_cast<std::size_t>(scene.output.duration_s * sample_rate_hz) + 1);
    EXPECT_EQ(simulation.advance(samples, samples.capacity()), Status::running);
    Drive drive = scene.drive;
    drive.kind = DriveKind::file;
    drive.quantity = DriveQuantity::velocity;
    drive.sample_rate_hz = sample_rate_hz;
    drive.samples.assign(samples[Tap::v_horn].begin(), samples[Tap::v_horn].end());
    return drive;
}

TEST(RecordedTone, GivesTheTonesOutputs) {
    Scene scene;
    scene.numerics.integrator = Integrator::taylor12;
    scene.numerics.step_s = 0.3e-6;
    const Record tone = recorded(scene, 5000);
    const Drive drive = scene.drive;
    struct Rate {
        double hz;
        double error;  // of the kink at the end of the burst, as the third power of the samples' distance
    };
    for (const Rate rate : {Rate{10e6, 2e-9}, Rate{20e6, 3e-10}}) {
        scene.drive = drive;
        scene.drive = recorded_tone(scene, rate.hz);
        const Record again = recorded(scene, 5000);
        EXPECT_LE(relative_l2(again.v_last, tone.v_last), rate.error);
        EXPECT_LE(relative_l2(again.v_plate, tone.v_plate), rate.error);
    }
}

}  // namespace
}  // namespace hertzline::test
