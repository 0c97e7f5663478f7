// Chains of different spheres, struck or under their own weight, and a swept tone against an independent solver. docs/validation.md has
// published numbers.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/chain.hpp"
#include "hertzline/resolve.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

class EveryMixedReference : public ::testing::TestWithParam<std::string> {
protected:
    EveryMixedReference()
        : scene_(random_reference_scene("mixed/" + GetParam())),
          reference_(read_reference("mixed/" + GetParam())) {}

    Comparison run(const Scene& scene) const { return compare_with_reference(scene, reference_); }
    Scene scene_;
    Reference reference_;
};

INSTANTIATE_TEST_SUITE_P(Scenes, EveryMixedReference,
                         ::testing::Values("dimer_tone", "defect_tone", "tapered_impact", "striker_train",
                                           "standing_chain", "chirp"),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryMixedReference, TheAccuracyAskedForIsKeptAndEstimated) {
    constexpr double shown_by_references = 1e-8;
    for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8}) {
        scene_.numerics.accuracy = accuracy;
        const Resolution settled = resolve(scene_);
        const Comparison errors = run(settled.scene);
        const double error = std::max({errors.v_last, errors.v_plate, errors.v_out});
        EXPECT_LE(error, accuracy + shown_by_references);
        ASSERT_TRUE(settled.estimate.has_value());
        EXPECT_GE(2 * settled.estimate->error + shown_by_references, error) << accuracy;
        EXPECT_LE(settled.estimate->error, 3 * std::max(error, shown_by_references)) << accuracy;
        EXPECT_LE(errors.energy_residual, std::max(10 * accuracy, 1e-8)) << accuracy;
    }
}

TEST_P(EveryMixedReference, EveryMethodConvergesToIt) {
    const double step = 0.02 / scene_.drive.frequency_hz / 8;
    for (const Integrator integrator : choices<Integrator>) {
        const Comparison errors = run(with_step(scene_, integrator, step));
        const double bound = integrator == Integrator::leapfrog ? 2e-3 : 2e-5;
        EXPECT_LE(errors.v_last, bound) << word(integrator);
        EXPECT_LE(errors.energy_residual, bound) << word(integrator);
    }
}

TEST(LateBurst, IsTheSameBurstLater) {
    Scene scene = with_step(Scene{}, Integrator::taylor8, 0.5e-6);
    scene.drive.sweep_to_hz = 90e3;
    constexpr std::size_t late = 100;  // samples
    for (const Integrator integrator : choices<Integrator>) {
        scene = with_step(scene, integrator, is_series(integrator) ? 0.3e-6 : 25e-9);
        scene.drive.start_s = 0;
        const Record now = recorded(scene, 3000);
        scene.drive.start_s = static_cast<double>(late) / scene.output.sample_rate_hz;
        const Record later = recorded(scene, 3000 + late);
        EXPECT_EQ(std::vector(later.v_last.begin(), later.v_last.begin() + late),
                  std::vector<double>(late, 0.0));
        const std::vector<double> from_start(later.v_last.begin() + late, later.v_last.end());
        // the step's grid moves against the burst's pieces, but not by more than rounding
        EXPECT_LE(relative_l2(from_start, now.v_last), 1e-8) << word(integrator);
    }
}

TEST(LateBurst, MustLieWithinItsPeriod) {
    Scene scene;
    scene.drive.repetition_hz = 2000;
    scene.drive.start_s = 150e-6;
    EXPECT_TRUE(validate(scene).empty());
    scene.drive.start_s = 160e-6;
    const std::vector<Fault> faults = validate(scene);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_THAT(faults.front().message(),
                testing::HasSubstr("drive.start_s: found 0.00016, allowed: at most 1 / repetition_hz"));
}

}  // namespace
}  // namespace hertzline::test
