// The error of a stream is estimated again when its motion leaves the range of the pilots, and only then.

#include "stream/inputs/estimate_watch.hpp"

#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "tests/support/seen_scenes.hpp"

namespace hertzline::test {

using namespace stream;
using testing::HasSubstr;

namespace {

MotionExtremes extent_after(const Scene& scene, double time_s) {
    Simulation simulation(scene);
    EXPECT_EQ(simulation.skip(static_cast<std::int64_t>(time_s * scene.output.sample_rate_hz)),
              Status::running);
    return simulation.extremes();
}

/// Waits until the estimate is ready.
EstimateWatch::News news_of(EstimateWatch& watch, const MotionExtremes& now) {
    EstimateWatch::News news;
    while (watch.estimating()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        news = watch.look(now);
    }
    return news;
}

TEST(EstimateWatch, EstimatesAgainWhenTheMotionGrows) {
    const Resolution resolved = resolve(growing_scene(), std::nullopt);
    EstimateWatch watch(resolved);
    const MotionExtremes grown = extent_after(resolved.scene, 4e-3);
    EXPECT_FALSE(watch.look(grown).estimated_again);
    ASSERT_TRUE(watch.estimating());
    const EstimateWatch::News news = news_of(watch, grown);
    EXPECT_TRUE(news.estimated_again);
    EXPECT_THAT(news.warning, HasSubstr("above the requested accuracy of 0.0001"));
    EXPECT_GE(watch.estimate()->over_s, 2 * 4e-3 * 0.999);
    EXPECT_GT(watch.estimate()->error, 1e-3);
    // the range now includes this motion
    EXPECT_EQ(watch.finish(grown).warning, "");
    EXPECT_EQ(watch.estimates(), 1);
}

TEST(EstimateWatch, AnArrayThatMovesAsItsEstimateHasSeenIsLeftAlone) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.drive.cycles = 2;
    scene.array.x_m = {0, 30e-3};
    scene.array.y_m = {0, 0};
    scene.array.coupling = Coupling::none;
    const Resolution resolved = resolve(scene, std::nullopt);
    ASSERT_TRUE(resolved.estimate);
    EstimateWatch watch(resolved);
    const MotionExtremes moved = extent_after(resolved.scene, 0.5 * resolved.estimate->over_s);
    EXPECT_GT(moved.largest_press_m, 0);
    EXPECT_EQ(watch.look(moved).warning, "");
    EXPECT_FALSE(watch.estimating());
}

TEST(EstimateWatch, DoesNothingWhileTheMotionIsSteady) {
    const Resolution resolved = resolve(steady_scene(), std::nullopt);
    EstimateWatch watch(resolved);
    Simulation simulation(resolved.scene);
    for (int looks = 0; looks < 30; ++looks) {
        EXPECT_EQ(simulation.skip(static_cast<std::int64_t>(1e-3 * resolved.scene.output.sample_rate_hz)),
                  Status::running);
        EXPECT_EQ(watch.look(simulation.extremes()).warning, "");
        ASSERT_FALSE(watch.estimating());
    }
    EXPECT_EQ(watch.finish(simulation.extremes()).warning, "");
    EXPECT_EQ(watch.estimate()->over_s, resolved.estimate->over_s);
}

TEST(EstimateWatch, SaysThatTheEstimateNoLongerHoldsWhenThereIsNoTimeForAnother) {
    const Resolution resolved = resolve(growing_scene(), std::nullopt);
    EstimateWatch watch(resolved);
    MotionExtremes grown = extent_after(resolved.scene, 4e-3);
    grown.time_s = 1;  // to reach that takes seconds
    watch.look(grown);
    ASSERT_TRUE(watch.estimating());
    EXPECT_THAT(watch.finish(grown).warning, HasSubstr("the estimate holds for the first 0.001 s only"));
    EXPECT_FALSE(watch.estimating());
    EXPECT_EQ(watch.estimate()->error, resolved.estimate->error);
}

TEST(EstimateWatch, AMotionThatLeavesAtTheVeryEndIsNamed) {
    const Resolution resolved = resolve(growing_scene(), std::nullopt);
    EstimateWatch watch(resolved);
    EXPECT_THAT(watch.finish(extent_after(resolved.scene, 4e-3)).warning,
                HasSubstr("later errors are not known"));
}

TEST(EstimateWatch, AnEstimateHoldsNoLongerThanTheMotionStays) {
    const Resolution resolved = resolve(growing_scene(), std::nullopt);
    EstimateWatch watch(resolved);
    MotionExtremes grown = extent_after(resolved.scene, 4e-3);
    grown.time_s = resolved.estimate->over_s / 2;  // the pilots' motion did not go as far in that time
    const EstimateWatch::News news = watch.finish(grown);
    EXPECT_THAT(news.warning, HasSubstr("the estimate holds for the first 0.0005 s only"));
    EXPECT_TRUE(news.estimated_again);
    EXPECT_EQ(watch.estimate()->over_s, grown.time_s);
}

TEST(EstimateWatch, LeavesAloneWhatHasNoEstimate) {
    Resolution resolved = resolve(growing_scene(), std::nullopt);
    const MotionExtremes grown = extent_after(resolved.scene, 4e-3);
    resolved.estimate.reset();
    EstimateWatch watch(resolved);
    EXPECT_EQ(watch.look(grown).warning, "");
    EXPECT_EQ(watch.finish(grown).warning, "");
}

}  // namespace
}  // namespace hertzline::test
