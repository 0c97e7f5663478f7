#include "stream/control/scene_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/scene_json.hpp"
#include "measures/provenance.hpp"
#include "tests/support/seen_scenes.hpp"

namespace hertzline::test {

using namespace measures;
using namespace stream;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;

namespace {

TEST(SceneChange, OnlyADriveLetsTheMotionGoOn) {
    const Scene scene = steady_scene();
    const auto with = [&](const Json& values) { return *with_values(scene, values); };
    EXPECT_TRUE(motion_goes_on(scene, with({{"drive.amplitude_m", 1e-6}, {"drive.repetition_hz", 500}})));
    EXPECT_TRUE(motion_goes_on(scene, with({{"numerics.step_s", 1e-8}})));
    EXPECT_FALSE(motion_goes_on(scene, with({{"drive.material", "aluminium"}})));
    EXPECT_FALSE(motion_goes_on(scene, with({{"chain.preload_n", 0.2}})));
    EXPECT_FALSE(motion_goes_on(scene, with({{"numerics.integrator", "leapfrog"}})));
}

TEST(SceneChange, WhatFramesHoldStays) {
    const Scene scene = steady_scene();
    const auto faults = [&](const Json& values) { return frame_faults(scene, *with_values(scene, values)); };
    EXPECT_TRUE(faults({{"chain.preload_n", 0.2}, {"end.thickness_m", 1e-3}}).empty());
    EXPECT_EQ(faults({{"output.points_m", {{0, 0, 0.01}}}}).front().key, "output.points_m");
    EXPECT_EQ(faults({{"output.sample_rate_hz", 1e6}, {"chain.spheres", 3}, {"end.kind", "wall"}}).size(),
              3U);
    EXPECT_EQ(faults({{"drive.kind", "live"}}).front().key, "drive.kind");
}

TEST(SceneChange, ARecordStaysAsItWasRead) {
    Scene scene = steady_scene();
    scene.drive.kind = DriveKind::file;
    scene.drive.samples.assign(20, 1e-6);
    scene.drive.sample_rate_hz = 1e6;
    scene.drive.quantity = DriveQuantity::displacement;
    const auto faults = [&](const Json& values) { return frame_faults(scene, *with_values(scene, values)); };
    EXPECT_THAT(faults({{"drive.sample_rate_hz", 2e6}}),
                ElementsAre(Field(&Fault::key, "drive.sample_rate_hz")));
    EXPECT_THAT(faults({{"drive.quantity", "velocity"}}), ElementsAre(Field(&Fault::key, "drive.quantity")));
    EXPECT_THAT(faults({{"drive.column", "2"}}), ElementsAre(Field(&Fault::key, "drive.column")));
    EXPECT_THAT(faults({{"drive.scale", 2}, {"drive.start_s", 1e-6}}), IsEmpty());
}

TEST(SceneChange, AnArrayKeepsItsElements) {
    const Scene array = *with_values(steady_scene(), {{"array.x_m", {-0.01, 0.01}}, {"array.y_m", {0, 0}}});
    const auto with = [&](const Json& values) { return *with_values(array, values); };
    const ::testing::Matcher<std::vector<Fault>> is_of_the_elements =
        ElementsAre(Field(&Fault::key, "array.x_m"));
    EXPECT_THAT(frame_faults(array, with({{"array.x_m", {0, 0.01, 0.02}}, {"array.y_m", {0, 0, 0}}})),
                is_of_the_elements);
    EXPECT_THAT(frame_faults(steady_scene(), array), is_of_the_elements);
    const Scene turned =
        with({{"array.focus_m", {0, 0, 0.02}}, {"array.delays_s", {1e-6}}, {"array.x_m[1]", 0}});
    EXPECT_THAT(frame_faults(array, turned), IsEmpty());
    EXPECT_FALSE(motion_goes_on(array, with({{"drive.amplitude_m", 1e-6}})));
}

TEST(SceneChange, PointsMayMoveAsLongAsTheyAreAsMany) {
    Scene scene = steady_scene();
    scene.end.model = PlateModel::modal;
    scene.output.points_m = {{0, 0, 0.01}, {0, 0, 0.02}};
    const auto faults = [&](const Json& values) { return frame_faults(scene, *with_values(scene, values)); };
    EXPECT_TRUE(faults({{"output.points_m[2][1]", 1e-3}}).empty());
    EXPECT_TRUE(faults({{"output.points_m", {{0, 0, 0.01}, {0, 1e-3, 0}}}}).empty());
    EXPECT_EQ(faults({{"output.points_m", {{0, 0, 0.01}}}}).front().key, "output.points_m");
}

TEST(SceneChange, ComesBackFromItsJson) {
    const SceneChange change{.sample = 20,
                             .epoch = 1,
                             .set = {{"drive.cycles", 3.0}},
                             .was = {{"drive.cycles", 5.0}},
                             .goes_on = true,
                             .scene_hash = "0123456789abcdef",
                             .estimate = ErrorEstimate{.error = 1e-5, .over_s = 2e-3}};
    const auto changes =
        changes_in(Json::array({change_json(change), {{"sample", 30}, {"set", {{"drive.cycles", 4}}}}}));
    ASSERT_TRUE(changes);
    EXPECT_EQ(change_json(changes->at(0))["was"], change_json(change)["was"]);
    EXPECT_EQ(changes->at(0).scene_hash, change.scene_hash);
    EXPECT_EQ(changes->at(0).estimate->error, 1e-5);
    EXPECT_EQ(changes->at(0).estimate->over_s, 2e-3);
    EXPECT_EQ(changes->at(1).epoch, 2);
    EXPECT_FALSE(changes_in(Json::object()));
    EXPECT_FALSE(changes_in(Json::array({{{"sample", 0}, {"set", Json::object()}}})));
    EXPECT_FALSE(changes_in(Json::array({{{"sample", 9}}})));
    EXPECT_FALSE(changes_in(
        Json::array({{{"sample", 9}, {"set", Json::object()}}, {{"sample", 9}, {"set", Json::object()}}})));
}

std::string fault_of(const Json& list) {
    const auto changes = changes_in(list);
    return changes ? "none" : changes.error();
}

TEST(SceneChange, FaultsNameWhatIsWrong) {
    using testing::HasSubstr;
    const Json set = Json::object();
    EXPECT_THAT(fault_of(Json::array({{{"sample", 0}, {"set", set}}})),
                HasSubstr("sample: found \"0\", allowed: a whole number from 1 to"));
    EXPECT_THAT(fault_of(Json::array({{{"set", set}}})), HasSubstr("sample: found none"));
    EXPECT_THAT(fault_of(Json::array({{{"sample", 9}, {"set", set}}, {{"sample", 9}, {"set", set}}})),
                HasSubstr("change 2: sample: found \"9\", allowed: a whole number from 10 to"));
    EXPECT_THAT(fault_of(Json::array({{{"sample", 9}, {"set", set}, {"foo", 1}}})),
                HasSubstr("the member \"foo\""));
    EXPECT_THAT(fault_of(Json::array({{{"sample", 9}, {"sets", set}}})), HasSubstr("the member \"sets\""));
    EXPECT_THAT(fault_of(Json::array({{{"sample", 9}, {"set", set}, {"motion", "begins a new"}}})),
                HasSubstr("motion: found \"begins a new\", allowed: goes on, begins anew"));
}

TEST(SceneChange, ASceneThatGaveNoSamplesMayHaveNone) {
    const Json set = Json::object();
    const auto changes = changes_in(Json::array(
        {{{"sample", 9}, {"set", set}}, {{"sample", 9}, {"set", set}, {"motion", "begins anew"}}}));
    ASSERT_TRUE(changes) << changes.error();
    EXPECT_TRUE(changes->at(0).goes_on);
    EXPECT_FALSE(changes->at(1).goes_on);
}

TEST(SceneChange, ProvenanceTellsTheEpochs) {
    const Json provenance{{"scene", {{"drive", {{"repetition_hz", 1000}}}}},
                          {"changes",
                           {{{"epoch", 1}, {"sample", 20'000}, {"set", {{"drive.repetition_hz", 500}}}},
                            {{"epoch", 2}, {"sample", 60'000}, {"set", {{"drive.cycles", 5}}}}}}};
    const std::vector<Epoch> epochs = epochs_of(provenance, 1e7);
    ASSERT_EQ(epochs.size(), 3U);
    EXPECT_EQ(epochs[1], (Epoch{1, 20'000, 2, 500}));
    EXPECT_EQ(epochs[2], (Epoch{2, 60'000, 4, 500}));
    EXPECT_EQ(epochs[2].at(1e7, 80'001), (BurstPlace{5, 1}));
    EXPECT_TRUE(epochs_of(Json::object(), 1e7).empty());
}

}  // namespace
}  // namespace hertzline::test
