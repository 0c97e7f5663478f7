// Sample rate and step are independent of each other.

#include <cmath>

#include <gtest/gtest.h>

#include "core/scene/scene_words.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {
namespace {

Scene sampled(Scene scene, double sample_rate_hz, Integrator integrator, double step_s) {
    scene.output.sample_rate_hz = sample_rate_hz;
    return with_step(scene, integrator, step_s);
}

struct Rates {
    double sample_rate_hz;
    double finest_step_s;  ///< fits the sample period
    std::size_t samples;
};

constexpr Rates all_rates[] = {{10e6, 5e-9, 4000},
                               {1e6, 5e-9, 400},
                               {44.1e3, 1 / (44.1e3 * 4000), 18},
                               {100e6, 5e-9, 30'000},
                               {1.6e6, 6.25e-9, 600}};

constexpr double off_grid_steps[] = {33e-9, 70e-9, 130e-9, 333e-9};

TEST(Sampling, StepsThatDoNotFitTheSampleRateGiveTheSameSamples) {
    for (const char* file : {"paper_wall", "paper_vitreous_carbon"}) {
        for (const Rates& rates : all_rates) {
            const Scene scene = reference_scene(file);
            const Record fine = recorded(
                sampled(scene, rates.sample_rate_hz, Integrator::chin4a, rates.finest_step_s), rates.samples);
            for (const double step : off_grid_steps) {
                const Record found =
                    recorded(sampled(scene, rates.sample_rate_hz, Integrator::chin4a, step), rates.samples);
                const double bound = 2e-3 * std::pow(step / 333e-9, 3);  // fourth order but for the contacts
                EXPECT_LE(relative_l2(found.v_last, fine.v_last), bound)
                    << rates.sample_rate_hz << ' ' << step;
                EXPECT_LE(relative_l2(found.v_out, fine.v_out), 10 * bound)
                    << rates.sample_rate_hz << ' ' << step;
                EXPECT_LE(relative_l2(found.chain_x, fine.chain_x), bound)
                    << rates.sample_rate_hz << ' ' << step;
            }
        }
    }
}

TEST(Sampling, TheLastSphereMovesAlikeInEveryTapThatShowsIt) {
    for (const Integrator integrator : choices<Integrator>) {
        for (const double step : off_grid_steps) {
            const Scene scene = sampled(reference_scene("paper_vitreous_carbon"), 10e6, integrator, step);
            Simulation simulation(scene, {.taps = TapSet(Tap::v_last) | Tap::v_chain});
            Samples samples = simulation.make_samples(2000);
            ASSERT_EQ(simulation.advance(samples, 2000), Status::running);
            const std::size_t spheres = samples.spheres();
            for (std::size_t i = 0; i < samples.count; ++i) {
                ASSERT_EQ(samples[Tap::v_last][i], samples[Tap::v_chain][(i + 1) * spheres - 1])
                    << word(integrator) << ' ' << step << ' ' << i;
            }
        }
    }
}

TEST(Sampling, LeapfrogStaysNearlySecondOrderBetweenSteps) {
    // an opening or closing bends the velocity between two steps, which the cubic through them does not know
    const Scene scene = reference_scene("paper_wall");
    const Record fine = recorded(sampled(scene, 10e6, Integrator::chin4a, 5e-9), 4000);
    const auto error = [&](double step) {
        return relative_l2(recorded(sampled(scene, 10e6, Integrator::leapfrog, step), 4000).v_last,
                           fine.v_last);
    };
    EXPECT_LE(error(17e-9), 6e-4);
    EXPECT_GE(std::log2(error(68e-9) / error(17e-9)) / 2, 1.7);
}

TEST(Sampling, SamplesOnTheGridAreThoseOfAFinerGrid) {
    const Scene scene = reference_scene("paper_vitreous_carbon");
    const Record coarse = recorded(sampled(scene, 1e6, Integrator::chin4a, 50e-9), 300);
    const Record fine = recorded(sampled(scene, 20e6, Integrator::chin4a, 50e-9), 6000);
    for (std::size_t i = 0; i < 300; ++i) {
        ASSERT_EQ(coarse.v_out[i], fine.v_out[20 * i]);
    }
}

TEST(Sampling, AStepWithinRoundingOfTheGridIsOnIt) {
    const Scene scene = reference_scene("paper_vitreous_carbon");
    const Record exact = recorded(sampled(scene, 10e6, Integrator::chin4a, 1e-7 / 3), 500);
    const Record nearly = recorded(sampled(scene, 10e6, Integrator::chin4a, 3.33333333333e-8), 500);
    EXPECT_EQ(exact, nearly);
}

TEST(Sampling, TheBeginningIsSampleZero) {
    for (const double step : {50e-9, 70e-9}) {
        Simulation simulation(sampled(Scene{}, 10e6, Integrator::chin4a, step), {});
        Samples part = simulation.make_samples(8);
        EXPECT_EQ(simulation.advance(part, 8), Status::running);
        EXPECT_EQ(part.first, 0);
        EXPECT_EQ(part.count, 8U);
        EXPECT_EQ(part[Tap::v_last][0], 0);
        EXPECT_NE(part[Tap::v_last][1], 0);
        EXPECT_EQ(simulation.advance(part, 8), Status::running);
        EXPECT_EQ(part.first, 8);
    }
}

TEST(Sampling, SkippingFarDoesNotShiftTheSamples) {
    // 0.3 s in one leap: moments are counted exactly, so the 300th burst is met where the 20th was. After 280 bursts, and
    // after 28, both steps fall on the burst as before.
    constexpr std::int64_t bursts = 20 + repeated(280);
    constexpr std::int64_t period = 10'000;  // samples
    Scene scene = reference_scene("paper_vitreous_carbon");
    scene.drive.repetition_hz = 1000;
    scene.drive.cycles = 5;
    scene.chain.damping_kg_per_s = 1;
    for (const double step : {50e-9, 70e-9}) {
        Simulation simulation(sampled(scene, 10e6, Integrator::chin4a, step));
        Samples early = simulation.make_samples(1000);
        Samples late = simulation.make_samples(1000);
        EXPECT_EQ(simulation.skip(period * 20), Status::running);
        EXPECT_EQ(simulation.advance(early, 1000), Status::running);
        EXPECT_EQ(simulation.skip(period * bursts - simulation.next_sample()), Status::running);
        EXPECT_EQ(simulation.advance(late, 1000), Status::running);
        EXPECT_EQ(late.first, period * bursts);
        EXPECT_LE(relative_l2(late[Tap::v_out], early[Tap::v_out]), 1e-10);
    }
}

TEST(Sampling, VelocitiesOfAVeryLongChainNeedLittleRoom) {
    // a row of a trace is a megabyte here, and few fit
    Scene scene = with_step(Scene{}, Integrator::leapfrog, 50e-9);
    scene.end.kind = EndKind::wall;
    scene.chain.spheres = 40'000;
    for (const Integrator integrator : choices<Integrator>) {
        Simulation simulation(with_step(scene, integrator, 50e-9), {.taps = everything});
        Samples part = simulation.make_samples(10);
        EXPECT_EQ(simulation.advance(part, 10), Status::running);
        EXPECT_EQ(part.count, 10U);
        EXPECT_GT(part[Tap::v_chain][9 * part.spheres()], 0);
    }
}

}  // namespace
}  // namespace hertzline::test
