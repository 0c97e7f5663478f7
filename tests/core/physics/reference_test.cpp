// hertzline against an independent solver: the promised accuracy, scene by scene.

#include "tests/support/reference.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

class EveryReference : public ::testing::TestWithParam<ReferenceScene> {
protected:
    Comparison run(Scene scene) const {
        return compare_with_reference(scene, read_reference(GetParam().file));
    }
};

INSTANTIATE_TEST_SUITE_P(Scenes, EveryReference, ::testing::ValuesIn(reference_scenes()),
                         [](const auto& instance) { return instance.param.file; });

void expect_errors_at_most(const Comparison& errors, double bound) {
    EXPECT_LE(errors.v_last, bound);
    EXPECT_LE(errors.v_plate, bound);
    EXPECT_LE(errors.v_out, bound);
}

TEST_P(EveryReference, DefaultSettingsKeepWhatTheyAimAt) {
    // promised: 1e-3; the default aims at 1e-4 in every body and gets it in v_out, too
    expect_errors_at_most(run(GetParam().scene), 2e-4);
}

TEST_P(EveryReference, AStepOf12NanosecondsIsFarBelowTheBound) {
    for (const Integrator integrator : locating_integrators()) {
        const Comparison errors = run(with_step(GetParam().scene, integrator, 12.5e-9));
        expect_errors_at_most(errors, 5e-6);      // promised: 1e-4; largest seen: 5e-7 (free end)
        EXPECT_LE(errors.energy_residual, 3e-6);  // promised: 1e-4
    }
}

TEST_P(EveryReference, LeapfrogAt12NanosecondsIsSecondOrderGood) {
    Scene scene = GetParam().scene;
    scene.numerics.step_s = 12.5e-9;
    scene.numerics.integrator = Integrator::leapfrog;
    const Comparison errors = run(scene);
    // 1e-4 but for the scenes that amplify errors: 2.2e-4 (2 mm), 5.4e-4 (free end), 1.1e-4 (sonic vacuum) were seen
    const bool amplifies = GetParam().file == "vitreous_carbon_2mm" || GetParam().file == "free_end" ||
                           GetParam().file == "sonic_vacuum_10";
    EXPECT_LE(errors.v_last, amplifies ? 1e-3 : 1e-4);
    EXPECT_LE(errors.energy_residual, 1e-4);
}

TEST_P(EveryReference, StepsThatDoNotFitTheSamplesAreAsGood) {
    for (const Integrator integrator : locating_integrators()) {
        // 3.03 steps a sample
        expect_errors_at_most(run(with_step(GetParam().scene, integrator, 33e-9)), 1e-4);
    }
}

TEST_P(EveryReference, AnAskedForAccuracyIsMetWithinAFactorOfThree) {
    for (const double accuracy : {1e-3, 1e-5, 1e-6}) {
        Scene scene = GetParam().scene;
        scene.numerics.accuracy = accuracy;
        const Comparison errors = run(scene);
        EXPECT_LE(errors.v_last, 3 * accuracy) << accuracy;
        EXPECT_LE(errors.v_plate, 3 * accuracy) << accuracy;
    }
}

TEST_P(EveryReference, TheEstimatedErrorIsTheTrueOneWithinAFactorOfThree) {
    constexpr double shown_by_references = 5e-9;
    const auto expect_agreement = [&](const Scene& scene) {
        const Resolution settled = resolve(scene);
        const Comparison errors = run(settled.scene);
        const double error = std::max({errors.v_last, errors.v_plate, errors.v_out});
        ASSERT_TRUE(settled.estimate.has_value());
        EXPECT_GE(settled.estimate->error * 3, error > shown_by_references ? error : 0) << errors.step_s;
        EXPECT_LE(settled.estimate->error, 3 * std::max(error, shown_by_references)) << errors.step_s;
    };
    for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8}) {
        Scene scene = GetParam().scene;
        scene.numerics.accuracy = accuracy;
        expect_agreement(scene);
    }
    for (const Integrator integrator : choices<Integrator>) {
        expect_agreement(with_step(GetParam().scene, integrator, 200e-9));
        expect_agreement(with_step(GetParam().scene, integrator, 87.654321e-9));
    }
    for (const Integrator integrator : series_integrators()) {
        expect_agreement(with_step(GetParam().scene, integrator, 0.7e-6));
    }
}

/// Returns log2 of the ratio of errors at steps h and h/2, over four steps.
std::vector<double> orders(const std::string& file, Integrator integrator, double coarsest) {
    const Reference reference = read_reference(file);
    std::vector<double> slopes;
    double before = 0;
    for (int halving = 0; halving <= 3; ++halving) {
        Scene scene = reference_scene(file);
        scene.numerics.integrator = integrator;
        scene.numerics.step_s = coarsest / std::exp2(halving);
        const double error = compare_with_reference(scene, reference).v_last;
        if (halving > 0) {
            slopes.push_back(std::log2(before / error));
        }
        before = error;
    }
    return slopes;
}

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Ge;
using ::testing::Le;

TEST(Order, LeapfrogIsSecondOrderWhereContactsStayClosed) {
    EXPECT_THAT(orders("small_amplitude_wall", Integrator::leapfrog, 200e-9),
                Each(AllOf(Ge(1.85), Le(2.15))));
}

TEST(Order, Chin4aIsFourthOrderWhereContactsStayClosed) {
    EXPECT_THAT(orders("small_amplitude_wall", Integrator::chin4a, 100e-9), Each(AllOf(Ge(3.8), Le(4.2))));
}

TEST(Order, FractionalContactKeepsLeapfrogSecondOrderThroughEveryOpening) {
    // freezing the contacts over a step would make it first order
    EXPECT_THAT(orders("paper_wall", Integrator::leapfrog, 100e-9), Each(AllOf(Ge(1.8), Le(2.2))));
}

TEST(Order, LocatedContactsAndTheirKicksKeepChin4aAboveThirdOrder) {
    // without the kicks at openings and closings about 2.5
    EXPECT_THAT(orders("paper_wall", Integrator::chin4a, 200e-9), Each(AllOf(Ge(3.3), Le(4.2))));
}

TEST(Order, TheEnergyResidualFallsWithTheMethodsOrder) {
    const Reference reference = read_reference("small_amplitude_wall");
    const auto residual = [&](Integrator integrator, double step) {
        Scene scene = reference_scene("small_amplitude_wall");
        scene.numerics.integrator = integrator;
        scene.numerics.step_s = step;
        return compare_with_reference(scene, reference).energy_residual;
    };
    for (const double step : {100e-9, 50e-9}) {
        const double second = residual(Integrator::leapfrog, step) / residual(Integrator::leapfrog, step / 2);
        const double fourth = residual(Integrator::chin4a, step) / residual(Integrator::chin4a, step / 2);
        EXPECT_NEAR(std::log2(second), 2, 0.3) << step;
        EXPECT_NEAR(std::log2(fourth), 4, 0.5) << step;
    }
}

}  // namespace
}  // namespace hertzline::test
