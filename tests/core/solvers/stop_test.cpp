// A simulation stops when a flag is set, or after a number of steps.

#include <atomic>

#include <gtest/gtest.h>

#include "core/model/tone_burst.hpp"
#include "core/step_choice/finer_run.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

constexpr double step_s = 100e-9;
constexpr std::int64_t steps_of_a_sample = 10'000;

Scene with_long_samples(Integrator integrator) {
    Scene scene = with_step(Scene{}, integrator, step_s);
    scene.output.sample_rate_hz = 1 / (step_s * static_cast<double>(steps_of_a_sample));
    return scene;
}

TEST(Stop, AfterSoManyStepsItEndsAmidASample) {
    for (const Integrator integrator : choices<Integrator>) {
        SCOPED_TRACE(word(integrator));
        const Scene scene = with_long_samples(integrator);
        Simulation few(scene, {.max_steps = steps_of_a_sample / 2});
        Samples samples = few.make_samples(4);
        EXPECT_EQ(few.advance(samples, 4), Status::stopped);
        EXPECT_LE(few.state().step, steps_of_a_sample / 2 + ToneBurst::batch_steps);
        Simulation enough(scene, {.max_steps = 100 * steps_of_a_sample});
        EXPECT_EQ(enough.advance(samples, 4), Status::running);
    }
}

TEST(Stop, AFlagEndsItAmidASample) {
    const std::atomic<bool> stop{true};
    for (const Integrator integrator : choices<Integrator>) {
        Simulation simulation(with_long_samples(integrator), {.stop = &stop});
        Samples samples = simulation.make_samples(4);
        EXPECT_EQ(simulation.advance(samples, 4), Status::stopped) << word(integrator);
        EXPECT_LE(simulation.state().step, ToneBurst::batch_steps) << word(integrator);
    }
}

TEST(Stop, PilotsEndAndShowNothing) {
    const std::atomic<bool> stop{true};
    EXPECT_FALSE(resolve(Scene{}, Scene{}.output.duration_s, &stop).estimate.has_value());
    EXPECT_TRUE(resolve(Scene{}).estimate.has_value());
}

TEST(Stop, AnEstimateOfARunEndsWhateverTheRunIs) {
    Scene scene = with_step(Scene{}, Integrator::taylor8, 1e-12);  // 1e9 pieces a millisecond
    scene.output.sample_rate_hz = 1e3;
    EXPECT_EQ(estimate_of_run(scene, 1, nullptr).estimate.over_s, 0);
    const ErrorEstimate all =
        estimate_of_run(with_step(Scene{}, Integrator::taylor8, 700e-9), 1e-3, nullptr).estimate;
    EXPECT_DOUBLE_EQ(all.over_s, 1e-3);
}

}  // namespace
}  // namespace hertzline::test
