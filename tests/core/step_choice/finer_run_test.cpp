#include "core/step_choice/finer_run.hpp"

#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::test {
namespace {

Scene shipped(std::string_view name) {
    return parse_scene(find_shipped_scene(name)->text, std::string(name))->scene;
}

/// Runs to the end with that step and a finer run beside it. Returns the estimated error.
ErrorEstimate estimate_with(Resolution resolved, double step_s) {
    resolved.scene.numerics.step_s = step_s;
    Simulation simulation(resolved.scene, {.taps = judged_outputs & taps_of(resolved.scene)});
    Samples block = simulation.make_samples(1001);
    FinerRun finer(resolved.scene, block.capacity(), nullptr);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(simulation.advance(block, block.capacity()), Status::running);
        EXPECT_TRUE(finer.follow(block));
    }
    return finer.estimate();
}

TEST(FinerRun, FindsWhatTheReferenceFinds) {
    for (const auto& [name, longest_s] :
         {std::pair("paper-vitreous-carbon", 1.2e-6), std::pair("wet-vitreous-carbon", 1.0e-6)}) {
        const Scene scene = shipped(name);
        for (const double step_s : {longest_s, 0.9e-6, 0.7e-6}) {
            SCOPED_TRACE(std::string(name) + " " + std::to_string(1e9 * step_s));
            Scene given = scene;
            given.numerics.step_s = step_s;
            const ErrorEstimate estimate = estimate_with(*resolve_unmeasured(scene), step_s);
            const double by_pilots = resolve(given, 500.4e-6).estimate->error;
            EXPECT_GT(estimate.error, 0.8 * by_pilots);
            EXPECT_LT(estimate.error, 1.2 * by_pilots);
            EXPECT_NEAR(estimate.over_s, 500.4e-6, 1e-9);
        }
    }
}

TEST(FinerRun, AMissIsShortenedUntilItIsNone) {
    Resolution resolved = *resolve_unmeasured(shipped("paper-vitreous-carbon"));
    const ErrorEstimate missed = estimate_with(resolved, 1.3e-6);
    ASSERT_GT(missed.error, resolved.advice.accuracy) << "not missed: this tests nothing";
    resolved.scene.numerics.step_s = 1.3e-6;
    const auto shorter = with_shorter_step(resolved, missed.error);
    ASSERT_TRUE(shorter);
    EXPECT_LT(estimate_with(*shorter, *shorter->scene.numerics.step_s).error, resolved.advice.accuracy);
}

TEST(FinerRun, NoStepHelpsAMotionThatIsChaoticOrHasFailed) {
    const Resolution resolved = *resolve_unmeasured(shipped("paper-vitreous-carbon"));
    EXPECT_FALSE(with_shorter_step(resolved, 0.5));
    EXPECT_FALSE(with_shorter_step(resolved, std::numeric_limits<double>::infinity()));
    EXPECT_FALSE(with_shorter_step(resolved, std::numeric_limits<double>::quiet_NaN()));
}

TEST(FinerRun, IsNotForScenesWhoseStepHasToBeMeasured) {
    const Scene scene = shipped("paper-vitreous-carbon");
    EXPECT_TRUE(resolve_unmeasured(scene));
    for (const auto& change : {
             +[](Scene& each) { each.numerics.integrator = Integrator::chin4a; },
             +[](Scene& each) { each.numerics.step_s = 1e-7; },
             +[](Scene& each) { each.chain.spheres = 501; },
         }) {
        Scene changed = scene;
        change(changed);
        EXPECT_FALSE(resolve_unmeasured(changed));
    }
    Scene of_few_poles = shipped("wet-vitreous-carbon");
    EXPECT_TRUE(resolve_unmeasured(of_few_poles));
    of_few_poles.numerics.poles = 16;
    of_few_poles.numerics.accuracy = 1e-6;
    EXPECT_FALSE(resolve_unmeasured(of_few_poles));
}

}  // namespace
}  // namespace hertzline::test
