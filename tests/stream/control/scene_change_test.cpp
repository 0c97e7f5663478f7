#include "stream/control/scene_change.hpp"

#include "measures/provenance.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "core/scene/scene_toml.hpp"
#include "tests/support/seen_scenes.hpp"

namespace hertzline::test {

using namespace measures;
using namespace stream;

namespace {

using testing::HasSubstr;

TEST(SceneChange, SetsNumbersIntegersWordsAndTakesOptionalValuesBack) {
    Scene scene;
    scene.end.stiffness_n_per_m = 1e6;
    scene.materials["mine"] = Solid{70e9, 0.3, 2700};
    const auto changed = with_values(scene, {{"drive.amplitude_m", 2e-6},
                                             {"drive.cycles", 10},
                                             {"end.modes", 3},
                                             {"drive.envelope", "tukey"},
                                             {"chain.material", "mine"},
                                             {"materials.mine.density_kg_per_m3", 2800},
                                             {"end.stiffness_n_per_m", nullptr}});
    ASSERT_TRUE(changed);
    EXPECT_EQ(changed->drive.amplitude_m, 2e-6);
    EXPECT_EQ(changed->drive.cycles, 10);
    EXPECT_EQ(changed->end.modes, 3);
    EXPECT_EQ(changed->drive.envelope, Envelope::tukey);
    EXPECT_EQ(std::get<Solid>(changed->materials.at("mine")).density_kg_per_m3, 2800);
    EXPECT_EQ(changed->end.stiffness_n_per_m, std::nullopt);
}

TEST(SceneChange, NamesEveryFault) {
    const auto changed = with_values(Scene{}, {{"drive.amplitud_m", 1},
                                               {"drive.amplitude_m", -1},
                                               {"drive.cycles", "many"},
                                               {"end.modes", 2.5},
                                               {"drive.envelope", "hanning"},
                                               {"drive.frequency_hz", nullptr}});
    ASSERT_FALSE(changed);
    const Json faults = faults_json(changed.error())["faults"];
    ASSERT_EQ(faults.size(), 6U);
    EXPECT_THAT(faults[0]["allowed"].get<std::string>(), HasSubstr("drive.amplitude_m"));
    EXPECT_EQ(faults[1]["key"], "drive.amplitude_m");
    EXPECT_EQ(faults[1]["found"], "-1");
    EXPECT_EQ(faults[1]["allowed"], "a number from 0 to 1 m");
    EXPECT_THAT(faults[1]["message"].get<std::string>(), HasSubstr("drive.amplitude_m: found -1, allowed: "));
    EXPECT_EQ(faults[3]["key"], "end.modes");
    EXPECT_THAT(faults[4]["allowed"].get<std::string>(), HasSubstr("\"hann\""));
    EXPECT_EQ(faults[5]["found"], "null");
}

TEST(SceneChange, DescribesEveryKeyOfAScene) {
    const auto all = described_values(Scene{}, {});
    ASSERT_TRUE(all);
    EXPECT_EQ(all->size(), scene_keys().size());
    const Json amplitude = (*all)["drive.amplitude_m"];
    EXPECT_EQ(amplitude["value"], 3e-6);
    EXPECT_EQ(amplitude["unit"], "m");
    EXPECT_EQ(amplitude["minimum"], 0);
    EXPECT_EQ(amplitude["maximum"], 1);
    EXPECT_EQ(amplitude["kind"], "number");
    EXPECT_FALSE(amplitude.contains("words"));
    EXPECT_EQ((*all)["end.modes"]["kind"], "integer");
    EXPECT_EQ((*all)["end.modes"]["maximum"], 6);
    EXPECT_EQ((*all)["drive.envelope"]["words"], Json({"hann", "tukey", "rectangular"}));
    EXPECT_THAT((*all)["medium.material"]["words"].dump(), HasSubstr("water"));
    EXPECT_EQ((*all)["end.stiffness_n_per_m"]["value"], nullptr);
    EXPECT_EQ(described_values(Scene{}, {"drive.cycles"})->size(), 1U);
    EXPECT_EQ(described_values(Scene{}, {"drive.cycle", "chain"}).error().size(), 2U);
}

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
    EXPECT_EQ(faults({{"output.sample_rate_hz", 1e6}, {"chain.spheres", 3}, {"end.kind", "wall"}}).size(),
              3U);
}

TEST(SceneChange, ComesBackFromItsJson) {
    const SceneChange change{.sample = 20,
                             .epoch = 1,
                             .set = {{"drive.cycles", 3.0}},
                             .was = {{"drive.cycles", 5.0}},
                             .goes_on = true,
                             .scene_hash = "0123456789abcdef"};
    const auto changes =
        changes_in(Json::array({change_json(change), {{"sample", 30}, {"set", {{"drive.cycles", 4}}}}}));
    ASSERT_TRUE(changes);
    EXPECT_EQ(change_json(changes->at(0))["was"], change_json(change)["was"]);
    EXPECT_EQ(changes->at(0).scene_hash, change.scene_hash);
    EXPECT_EQ(changes->at(1).epoch, 2);
    EXPECT_FALSE(changes_in(Json::object()));
    EXPECT_FALSE(changes_in(Json::array({{{"sample", 0}, {"set", Json::object()}}})));
    EXPECT_FALSE(changes_in(Json::array({{{"sample", 9}}})));
    EXPECT_FALSE(changes_in(
        Json::array({{{"sample", 9}, {"set", Json::object()}}, {{"sample", 9}, {"set", Json::object()}}})));
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
