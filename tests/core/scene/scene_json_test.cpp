#include "core/scene/scene_json.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"

namespace hertzline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(SceneJson, EveryShippedSceneComesBackFromIt) {
    for (const ShippedScene& shipped : shipped_scenes()) {
        Scene scene = parse_scene(shipped.text, shipped.name).value().scene;
        scene.materials = {{"tin", Solid{50e9, 0.36, 7265, 9e6, {}}}, {"oil", Fluid{900, 1400}}};
        const auto back = scene_of_json(scene_json(scene));
        ASSERT_TRUE(back) << back.error().front().message();
        EXPECT_EQ(*back, scene) << shipped.name;
    }
}

TEST(SceneJson, KeysThatItLeavesOutHaveTheirDefaults) {
    Scene expected;
    expected.chain.spheres = 7;
    EXPECT_EQ(scene_of_json({{"chain", {{"spheres", 7}}}}).value(), expected);
    EXPECT_EQ(scene_of_json(Json::object()).value(), Scene{});
}

TEST(SceneJson, NamesEveryFaultOfASceneThatIsNone) {
    const auto faulty = [](const Json& json) {
        std::vector<std::string> keys;
        const auto scene = scene_of_json(json);
        std::ranges::transform(scene ? std::vector<Fault>{} : scene.error(), std::back_inserter(keys),
                               &Fault::key);
        return keys;
    };
    EXPECT_THAT(faulty(nullptr), ElementsAre("scene"));
    EXPECT_THAT(faulty({{"drive", 3}, {"materials", {{"a b", 1}}}}),
                ElementsAre("\"drive\"", R"("materials.\"a b\"")"));
    EXPECT_THAT(
        faulty({{"chain", {{"spheres", 0}, {"sphere", 1}}}, {"materials", {{"oil", {{"colour", 1}}}}}}),
        ElementsAre("chain.spheres", "\"chain.sphere\"", "\"materials.oil.colour\""));
    EXPECT_THAT(faulty({{"chain", {{"diameters_m", Json::object()}}}, {"drive", Json::object()}}),
                ElementsAre("chain.diameters_m"));
}

TEST(SceneJson, ItsSchemaHasEveryKeyWithItsBounds) {
    const Json schema = scene_schema();
    for (const SceneKey& key : scene_keys()) {
        const Json& entry = schema["properties"][key.section()]["properties"].at(std::string(key.key));
        EXPECT_EQ(entry["default"], json_of(key.value(Scene{}))) << key.name;
        EXPECT_FALSE(entry["description"].get<std::string>().empty()) << key.name;
    }
    const Json& end = schema["properties"]["end"]["properties"];
    EXPECT_EQ(end["modes"]["maximum"], 6);
    EXPECT_EQ(end["modes"]["needs"]["end.model"], "modal");
    EXPECT_EQ(end["kind"]["enum"], Json({"plate", "wall", "free"}));
    EXPECT_EQ(end["stiffness_n_per_m"]["type"], Json({"number", "null"}));
    const Json& solid = schema["properties"]["materials"]["additionalProperties"]["anyOf"][0];
    EXPECT_EQ(solid["properties"]["poissons_ratio"]["exclusiveMaximum"], 0.5);
    EXPECT_EQ(solid["required"].size(), 3U);
}

TEST(SceneValues, SetsNumbersIntegersWordsAndTakesOptionalValuesBack) {
    Scene scene;
    scene.end.stiffness_n_per_m = 1e6;
    scene.materials["mine"] = Solid{70e9, 0.3, 2700};
    const auto changed = with_values(scene, {{"drive.amplitude_m", 2e-6},
                                             {"drive.cycles", 10},
                                             {"drive.frequency_hz", "60 kHz"},
                                             {"end.modes", 3},
                                             {"drive.envelope", "tukey"},
                                             {"chain.material", "mine"},
                                             {"materials.mine.density_kg_per_m3", 2800},
                                             {"end.stiffness_n_per_m", nullptr}});
    ASSERT_TRUE(changed);
    EXPECT_EQ(changed->drive.amplitude_m, 2e-6);
    EXPECT_EQ(changed->drive.cycles, 10);
    EXPECT_EQ(changed->drive.frequency_hz, 60e3);
    EXPECT_EQ(changed->end.modes, 3);
    EXPECT_EQ(changed->drive.envelope, Envelope::tukey);
    EXPECT_EQ(std::get<Solid>(changed->materials.at("mine")).density_kg_per_m3, 2800);
    EXPECT_EQ(changed->end.stiffness_n_per_m, std::nullopt);
}

TEST(SceneValues, NamesEveryFault) {
    const auto changed = with_values(Scene{}, {{"drive.amplitud_m", 1},
                                               {"drive.amplitude_m", -1},
                                               {"drive.cycles", "viele \u00b5"},
                                               {"end.modes", 2.5},
                                               {"drive.envelope", "hanning"},
                                               {"drive.frequency_hz", nullptr}});
    ASSERT_FALSE(changed);
    std::vector<std::string> messages;
    std::ranges::transform(changed.error(), std::back_inserter(messages), &Fault::message);
    EXPECT_THAT(
        messages,
        ElementsAre(HasSubstr("did you mean 'drive.amplitude_m'?"),
                    "drive.amplitude_m: found -1, allowed: a number from 0 to 1 m",
                    StartsWith("drive.cycles: found \"viele \u00b5\", allowed: a number from 0.001"),
                    "end.modes: found 2.5, allowed: an integer from 1 to 6",
                    StartsWith("drive.envelope: found \"hanning\", allowed: one of \"hann\""),
                    "drive.frequency_hz: found null, allowed: a number from 0.001 to 1e+09 Hz, always"));
}

TEST(SceneValues, DescribesEveryKeyOfAScene) {
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

}  // namespace
}  // namespace hertzline
