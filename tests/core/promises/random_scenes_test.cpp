// Scenes drawn within the bounds of validate(). Each run is finite and its ledger closes, or it is refused or stopped with
// a reason. bench_random_scenes runs ten thousand of them.

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "tests/support/draw.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/random_scene.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/trial.hpp"

namespace hertzline::test {
namespace {

/// Expects that hundreds of scenes, drawn with these seeds, keep every promise, and that most of them run.
template <class Drawn>
void expect_reasons(std::uint64_t first, Drawn drawn) {
    int ran = 0;
    constexpr int count = repeated(400);
    for (int i = 0; i < count; ++i) {
        const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
        const Scene scene = drawn(seed);
        ASSERT_TRUE(validate(scene).empty()) << to_toml(scene);
        const Trial trial = tried(scene);
        EXPECT_TRUE(trial.findings.empty()) << "seed " << seed << ": " << trial.findings.front() << '\n'
                                            << to_toml(scene);
        ran += trial.outcome == Outcome::ran ? 1 : 0;
    }
    EXPECT_GT(ran, count / 2);
}

TEST(RandomScenes, RunOrAreStoppedWithAReason) {
    expect_reasons(1'000'000, random_scene);  // others than those of the benchmark
}

/// Returns the scene with a law of damping that only series support.
Scene with_damping_law(Scene scene, std::uint64_t seed) {
    Draw draw(~seed);
    scene.chain.damping_law = draw.any(std::array{DampingLaw::kuwabara_kono, DampingLaw::tsuji});
    // from next to nothing to no rebound at all
    scene.chain.damping_time_s = draw.zero_or(draw.magnitude(1e-11, 1e-4));
    scene.chain.damping_alpha = draw.zero_or(draw.magnitude(1e-4, 10));
    if (scene.numerics.integrator && !is_series(*scene.numerics.integrator)) {
        scene.numerics.integrator = draw.any(std::array{Integrator::taylor8, Integrator::taylor12});
    }
    return scene;
}

TEST(RandomScenes, RunOrAreStoppedWithAReasonWhateverTheLawOfDamping) {
    expect_reasons(2'000'000, [](std::uint64_t seed) { return with_damping_law(random_scene(seed), seed); });
}

TEST(RandomScenes, DivergedRunsNameStepTimeAndContact) {
    // so far beyond the limit that the overlaps are no numbers at the end of the first block
    for (const Integrator integrator : grid_integrators()) {
        Scene scene = with_step(Scene{}, integrator, 10e-6);
        scene.output.sample_rate_hz = 1e5;
        Simulation simulation(scene, {.taps = everything});
        Samples part = simulation.make_samples(4000);
        EXPECT_EQ(simulation.advance(part, 4000), Status::unstable);
        EXPECT_EQ(part.count, 0U);
        const std::string failure = simulation.failure();
        EXPECT_NE(failure.find("the step of 1e-05 s"), std::string::npos) << failure;
        EXPECT_NE(failure.find("t = "), std::string::npos) << failure;
        EXPECT_NE(failure.find("contact "), std::string::npos) << failure;
        EXPECT_EQ(failure.find("nan"), std::string::npos) << failure;
    }
}

TEST(RandomScenes, ASeriesThatStallsIsStoppedWithAReason) {
    // a step of 1 us where the dashpots ask for pieces below 1e-12 s
    for (const Integrator integrator : series_integrators()) {
        Scene scene = with_step(Scene{}, integrator, 1e-6);
        scene.chain.damping_kg_per_s = 3e6;
        Simulation simulation(scene, {.taps = everything});
        Samples part = simulation.make_samples(64);
        EXPECT_EQ(simulation.advance(part, 64), Status::unstable);
        EXPECT_EQ(part.count, 0U);
        const std::string failure = simulation.failure();
        for (const char* what : {"steps of at most 1e-06 s", "t = ", "contact "}) {
            EXPECT_NE(failure.find(what), std::string::npos) << failure;
        }
        EXPECT_EQ(simulation.advance(part, 64), Status::unstable);
    }
}

TEST(RandomScenes, AStepOfManyPeriodsOfTheHornIsShortenedToWhatItsSeriesReaches) {
    // a sphere in flight does not tell how far to trust the horn's series, which meets it again and again
    Scene scene;
    scene.chain.spheres = 1;
    scene.chain.preload_n = 0;
    scene.end.kind = EndKind::free;
    for (const Integrator integrator : series_integrators()) {
        const Record expected = recorded(with_step(scene, integrator, 0.3e-6), 3500);
        for (const double step : {30e-6, 300e-6}) {
            const Record record = recorded(with_step(scene, integrator, step), 3500);
            double largest = 0;
            double apart = 0;
            for (std::size_t i = 0; i < record.v_last.size(); ++i) {
                largest = std::max(largest, std::abs(expected.v_last[i]));
                apart = std::max(apart, std::abs(record.v_last[i] - expected.v_last[i]));
            }
            EXPECT_LT(apart, 0.3 * largest) << word(integrator);  // twice of it and more beyond the reach
        }
    }
}

TEST(RandomScenes, OverdampedClampedContactsThatGrazeDoNotHoldTimeBack) {
    // coming apart, dashpots and elasticity cancel to rounding in all contacts at once
    Scene scene = with_step(Scene{}, Integrator::taylor12, 9.5e-11);
    scene.drive.envelope = Envelope::rectangular;
    scene.drive.frequency_hz = 3500;
    scene.drive.amplitude_m = 2e-8;
    scene.chain.spheres = 21;
    scene.chain.diameter_m = 0.1e-3;
    scene.chain.damping_kg_per_s = 22;
    scene.chain.preload_n = 0;
    scene.chain.tension = Tension::clamped;
    scene.end.kind = EndKind::free;
    scene.output.sample_rate_hz = 1e9;
    Simulation simulation(scene);
    ASSERT_EQ(simulation.skip(400), Status::running);
    EXPECT_LT(simulation.steps(), 20'000);
}

}  // namespace
}  // namespace hertzline::test
