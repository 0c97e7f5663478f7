// The estimated error of the step in use, chosen or given. Against the
// references of tests/reference: reference_test.cpp.

#include "core/step_choice/reference_pilot.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/scene/scene_words.hpp"
#include "core/step_choice/resolve.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

TEST(Estimate, HoldsForChainsThatRegistersDoNotHold) {
    Scene scene;
    scene.chain.spheres = 100;
    scene.end.kind = EndKind::wall;
    const ResolvedScene settled = resolve(scene);
    ASSERT_EQ(settled.scene.numerics.integrator, Integrator::leapfrog);
    ASSERT_TRUE(settled.estimated_error.has_value());
    const Record fine = recorded(with_step(scene, Integrator::taylor12, 150e-9), 5000);
    const double error = relative_l2(recorded(settled.scene, 5000).chain_v, fine.chain_v);
    EXPECT_GT(*settled.estimated_error, error / 3);
    EXPECT_LT(*settled.estimated_error, error * 3);
}

TEST(Estimate, IsLeftOutWhereAPilotWouldTakeTooLong) {
    const ResolvedScene settled = resolve(with_step(Scene{}, Integrator::taylor8, 1e-12));
    EXPECT_TRUE(settled.faults.empty());
    EXPECT_FALSE(settled.estimated_error.has_value());
    EXPECT_NEAR(settled.steps_per_burst, 25 / 73e3 / 1e-12, 1);
}

TEST(Estimate, IsNeverBelowWhatTheReferenceIsGoodFor) {
    const ReferencePilot reference((Scene()));
    EXPECT_GT(reference.error(), 1e-14);
    EXPECT_LT(reference.error(), 1e-9);
    EXPECT_EQ(reference.trial(Integrator::taylor12, reference.step_s()).error, reference.error());
}

TEST(Estimate, StepsPerBurstAreThoseThatARunTakes) {
    for (const Integrator integrator : choices<Integrator>) {
        Scene scene;
        scene.numerics.integrator = integrator;
        const ResolvedScene settled = resolve(scene);
        Simulation simulation(settled.scene);
        simulation.skip(static_cast<std::int64_t>(1.5 * 25 / 73e3 * 10e6));
        EXPECT_NEAR(static_cast<double>(simulation.steps()) / (1.5 * settled.steps_per_burst), 1, 0.01);
    }
}

}  // namespace
}  // namespace hertzline::test
