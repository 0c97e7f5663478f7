// The range of the pilots' motion, the time at which a motion leaves it, and the estimate over a longer stretch.

#include "core/step_choice/long_estimate.hpp"

#include <gtest/gtest.h>

#include "hertzline/resolve.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/seen_scenes.hpp"

namespace hertzline::test {
namespace {

/// Returns the time at which the motion leaves the range of the pilots [s], checked every millisecond, or nullopt.
std::optional<double> left_at(const Resolution& resolved, double end_s) {
    Simulation simulation(resolved.scene);
    EventRate rate(resolved.scene.drive);
    while (simulation.time_s() < end_s) {
        EXPECT_EQ(simulation.skip(static_cast<std::int64_t>(1e-3 * resolved.scene.output.sample_rate_hz)),
                  Status::running);
        const MotionExtremes now = simulation.extremes();
        rate.note(now.time_s, now.contact_events);
        if (exceeds(now, rate, resolved.seen)) {
            return now.time_s;
        }
    }
    return std::nullopt;
}

TEST(SeenMotion, OfASteadySceneIsNeverLeft) {
    for (const Integrator integrator : {Integrator::taylor8, Integrator::leapfrog, Integrator::chin4a}) {
        Scene scene = shipped("paper-aluminium");  // where the ledger of chin4a errs most for its error
        scene.drive.repetition_hz = 1000;
        scene.numerics.integrator = integrator;
        EXPECT_EQ(left_at(resolve(scene, std::nullopt), 0.03), std::nullopt);
    }
}

TEST(SeenMotion, OfAGrowingSceneIsLeft) {
    const Resolution resolved = resolve(growing_scene(), std::nullopt);
    EXPECT_LE(resolved.estimate->error, default_accuracy);
    EXPECT_LE(left_at(resolved, 0.01).value_or(1), 4e-3);
}

TEST(SeenMotion, IsLeftByPressEventsAndEnergy) {
    const Scene scene = steady_scene();  // 1000 bursts a second
    const SeenMotion seen{
        .largest_press_m = 2e-6, .last_press_m = 1e-6, .events_per_s = 1e4, .energy_residual = 1e-3};
    const MotionExtremes like{.time_s = 0.1,
                              .largest_press_m = 2e-6,
                              .last_press_m = 1e-6,
                              .contact_events = 1000,
                              .energy_residual = 1e-3};
    const auto is_left_by = [&](const MotionExtremes& now) {
        EventRate rate(scene.drive);
        rate.note(now.time_s, now.contact_events);
        return exceeds(now, rate, seen);
    };
    EXPECT_FALSE(is_left_by(like));
    MotionExtremes other = like;
    other.largest_press_m *= 1.3;
    EXPECT_TRUE(is_left_by(other));
    other = like;
    other.last_press_m *= 1.3;
    EXPECT_TRUE(is_left_by(other));
    other = like;
    other.contact_events = 1300;
    EXPECT_TRUE(is_left_by(other));
    other = like;
    other.energy_residual *= 1.3;
    EXPECT_TRUE(is_left_by(other));
}

TEST(EventRate, CountsByPeriodsOfTheBursts) {
    EventRate rate(steady_scene().drive);
    rate.note(0.5e-3, 100);
    EXPECT_DOUBLE_EQ(rate.largest(), 200e3);  // of the period that has begun
    rate.note(1e-3, 120);
    rate.note(2e-3, 130);
    EXPECT_DOUBLE_EQ(rate.largest(), 120e3);
    EXPECT_FALSE(rate.exceeds(6e3));  // 10e3, and it may be one period's more
    EXPECT_TRUE(rate.exceeds(3e3));
    rate.note(2.5e-3, 1000);
    EXPECT_FALSE(rate.exceeds(3e3));  // that period is not complete
}

TEST(LongEstimate, IsThatOfThePilotsOverTheirStretch) {
    const Resolution resolved = resolve(steady_scene(), std::nullopt);
    const std::atomic<bool> stop{false};
    LongEstimate again(resolved.scene, resolved.advice.accuracy, &stop);
    ASSERT_TRUE(again.reach(resolved.estimate->over_s));
    EXPECT_NEAR(again.estimate().error, resolved.estimate->error, 1e-3 * resolved.estimate->error);
    EXPECT_NEAR(again.estimate().over_s, resolved.estimate->over_s, 1e-6);
    EXPECT_NEAR(again.seen().largest_press_m, resolved.seen.largest_press_m, 1e-12);
}

TEST(LongEstimate, IsTheErrorOfAMotionThatHasGrown) {
    const Resolution resolved = resolve(growing_scene(), std::nullopt);
    const std::atomic<bool> stop{false};
    LongEstimate longer(resolved.scene, resolved.advice.accuracy, &stop);
    ASSERT_TRUE(longer.reach(2e-3));
    const double before = longer.estimate().error;
    ASSERT_TRUE(longer.reach(4e-3));  // on from there
    const double rate = resolved.scene.output.sample_rate_hz;
    const auto samples = static_cast<std::size_t>(4e-3 * rate);
    const Record fine = recorded(with_step(resolved.scene, Integrator::taylor12, 150e-9), samples);
    const double error = relative_l2(recorded(resolved.scene, samples).v_out, fine.v_out);
    EXPECT_GT(longer.estimate().error, 10 * before);
    EXPECT_GT(longer.estimate().error, error / 3);
    EXPECT_LT(longer.estimate().error, error * 3);
    EXPECT_GT(longer.seen().largest_press_m, drift_margin * resolved.seen.largest_press_m);
}

TEST(LongEstimate, EndsWhenItIsStopped) {
    const Resolution resolved = resolve(steady_scene(), std::nullopt);
    const std::atomic<bool> stop{true};
    LongEstimate stopped(resolved.scene, resolved.advice.accuracy, &stop);
    EXPECT_FALSE(stopped.reach(stopped.longest_s()));
    EXPECT_LT(stopped.estimate().over_s, 1e-3);
}

}  // namespace
}  // namespace hertzline::test
