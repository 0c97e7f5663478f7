// A chain that has come to rest between bursts sleeps until the next, if the scene allows it.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/model/energy.hpp"
#include "hertzline/resolve.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

Scene bursts(double rest_tolerance) {
    Scene scene = with_step(Scene{}, Integrator::taylor8, 700e-9);
    scene.drive.repetition_hz = 1000;
    scene.numerics.rest_tolerance = rest_tolerance;
    return scene;
}

constexpr std::size_t three_bursts = 30'000;

TEST(Rest, SleepsExactlyStillUntilTheNextBurst) {
    const Record asleep = recorded(bursts(1e-3), three_bursts);
    const Record awake = recorded(bursts(0), three_bursts);
    for (std::size_t burst = 0; burst < 3; ++burst) {
        const auto last = asleep.v_last.begin() + static_cast<std::ptrdiff_t>(10'000 * burst);
        EXPECT_TRUE(std::all_of(last + 6000, last + 10'000, [](double v) { return v == 0; }));
        EXPECT_NE(last[4000], 0);
    }
    // a motion of 1e-3 of the horn's is cut off
    EXPECT_LE(relative_l2(asleep.v_last, awake.v_last), 2e-3);
    EXPECT_GT(relative_l2(asleep.v_last, awake.v_last), 1e-5);
}

TEST(Rest, EveryBurstThatFindsTheChainAtRestGivesTheSame) {
    const Record asleep = recorded(bursts(1e-3), three_bursts);
    for (std::size_t i = 0; i < 10'000; ++i) {
        ASSERT_NEAR(asleep.v_last[i + 10'000], asleep.v_last[i], 1e-9) << i;
        ASSERT_NEAR(asleep.v_last[i + 20'000], asleep.v_last[i], 1e-9) << i;
    }
}

TEST(Rest, TakesFewerPiecesAndKeepsTheBooks) {
    Simulation asleep(bursts(1e-3));
    Simulation awake(bursts(0));
    ASSERT_EQ(asleep.skip(three_bursts), Status::running);
    ASSERT_EQ(awake.skip(three_bursts), Status::running);
    EXPECT_LT(asleep.steps(), 0.75 * static_cast<double>(awake.steps()));
    EXPECT_LE(asleep.energy_residual(), 1e-6);
    EXPECT_EQ(asleep.contact_events(), awake.contact_events());
}

TEST(Rest, BooksTheEnergyOfAModalPlateOnce) {
    Scene scene = bursts(1e-2);
    scene.numerics.step_s = 400e-9;
    scene.end.model = PlateModel::modal;
    Simulation simulation(scene);
    ASSERT_EQ(simulation.skip(three_bursts), Status::running);
    EXPECT_EQ(simulation.ledger().plate_held, 0);
    EXPECT_LE(simulation.energy_residual(), 1e-9);
}

TEST(Rest, NeverComesWhereRestIsNotTheStartingPoint) {
    for (const bool unbalanced : {false, true}) {
        Scene scene = bursts(1e-3);
        if (unbalanced) {
            scene.end.preload = PlatePreload::as_printed;
        } else {
            scene.chain.preload_n = 0;
        }
        Scene awake = scene;
        awake.numerics.rest_tolerance = 0;
        EXPECT_EQ(recorded(scene, 10'000), recorded(awake, 10'000));
    }
}

TEST(Rest, TheEstimatedErrorHasTheMotionThatIsCutOff) {
    for (const double tolerance : {1e-4, 1e-3}) {
        Scene scene = bursts(tolerance);
        scene.output.duration_s = 2e-3;
        const Record asleep = recorded(scene, 20'000);
        const Record awake = recorded(bursts(0), 20'000);
        const double cut_off =
            std::max({relative_l2(asleep.v_last, awake.v_last), relative_l2(asleep.v_plate, awake.v_plate),
                      relative_l2(asleep.v_out, awake.v_out)});
        for (const bool step_is_given : {true, false}) {
            if (!step_is_given) {
                scene.numerics.step_s.reset();
            }
            const Resolution resolved = resolve(scene);
            ASSERT_TRUE(resolved.estimate.has_value());
            EXPECT_GT(resolved.estimate->error, cut_off / 2) << tolerance;
            EXPECT_LT(resolved.estimate->error, 3 * cut_off + default_accuracy) << tolerance;
        }
    }
}

TEST(Rest, IsRefusedWhereNoSeriesRuns) {
    Scene scene = bursts(1e-3);
    scene.numerics.integrator = Integrator::chin4a;
    scene.numerics.step_s = 100e-9;
    ASSERT_EQ(resolve(scene).faults.size(), 1U);
    EXPECT_EQ(resolve(scene).faults.front().key, "numerics.rest_tolerance");
}

}  // namespace
}  // namespace hertzline::test
