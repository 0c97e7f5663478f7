// Lists as values of keys: from TOML, options, texts and JSON, entry by entry.

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/scene_json.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/toml_entries.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/list_values.hpp"

namespace hertzline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* two_layers =
    "[end]\nmaterials = ['aluminium', 'acrylic']\nthicknesses_m = [2e-4, '0.5 mm']\n";

Scene layered_scene() {
    return parse_scene(two_layers, "scene.toml").value().scene;
}

std::vector<std::string> faults_in(const std::string& text, const std::vector<std::string>& options = {}) {
    std::vector<std::string> messages;
    if (const auto parsed = parse_scene(text, "scene.toml", options); !parsed) {
        std::ranges::transform(parsed.error(), std::back_inserter(messages), &Fault::message);
    }
    return messages;
}

std::vector<std::string> faults_of_values(const Json& values) {
    std::vector<std::string> messages;
    if (const auto scene = with_values(layered_scene(), values); !scene) {
        std::ranges::transform(scene.error(), std::back_inserter(messages), &Fault::message);
    }
    return messages;
}

SceneKey points_key() {
    return scene_key_named(Scene{}, "output.points_m").value();
}

TEST(SceneLists, AreReadFromFilesWithUnitsAndFromOptionsWithoutQuotes) {
    const Scene scene = layered_scene();
    EXPECT_THAT(scene.end.materials, ElementsAre("aluminium", "acrylic"));
    EXPECT_THAT(scene.end.thicknesses_m, ElementsAre(2e-4, 5e-4));
    EXPECT_THAT(scene.end.loss_factors, IsEmpty());
    for (const char* materials :
         {"[aluminium,acrylic]", "[ aluminium , \"acrylic\", ]", "['aluminium', 'acrylic']"}) {
        const std::vector<std::string> options{std::string("end.materials=") + materials,
                                               "end.thicknesses_m=[0.2mm, 0.5mm]"};
        EXPECT_EQ(parse_scene("", "scene.toml", options).value().scene, scene) << materials;
    }
    EXPECT_THAT(
        parse_scene("[end]\nmaterials = ['pyrex']\nthicknesses_m = [1]", "x").value().scene.end.thicknesses_m,
        ElementsAre(1.0));
}

TEST(SceneLists, OptionsSetEntriesAndTheLastOneWins) {
    const auto thicknesses = [](const std::vector<std::string>& options) {
        return parse_scene(two_layers, "scene.toml", options).value().scene.end.thicknesses_m;
    };
    EXPECT_THAT(thicknesses({"end.thicknesses_m[2]=1mm"}), ElementsAre(2e-4, 1e-3));
    EXPECT_THAT(thicknesses({"end.thicknesses_m[2]=1mm", "end.thicknesses_m[2]=2mm"}),
                ElementsAre(2e-4, 2e-3));
    EXPECT_THAT(thicknesses({"end.thicknesses_m=[3e-4, 4e-4]", "end.thicknesses_m[1]=1e-3"}),
                ElementsAre(1e-3, 4e-4));
    EXPECT_THAT(thicknesses({"end.thicknesses_m[1]=1e-3", "end.thicknesses_m=[3e-4, 4e-4]"}),
                ElementsAre(3e-4, 4e-4));
    EXPECT_EQ(parse_scene(two_layers, "x", std::vector<std::string>{"end.materials[1]=pyrex"})
                  .value()
                  .scene.end.materials[0],
              "pyrex");
}

TEST(SceneLists, FaultsNameTheEntryItsValueAndItsBounds) {
    const std::string number = "a number from 1e-09 to 10 m";
    const std::string list = "a list [A, B, ...] of at most 16 entries, each " + number;
    const std::string begin = "scene.toml:2: end.thicknesses_m";
    const auto of_thicknesses = [](const std::string& value) {
        return faults_in("[end]\nthicknesses_m = " + value);
    };
    EXPECT_THAT(of_thicknesses("[1e-3, -1]"), testing::Contains(begin + "[2]: found -1, allowed: " + number));
    EXPECT_THAT(of_thicknesses("[nan, 1]"), testing::Contains(begin + "[1]: found nan, allowed: " + number));
    EXPECT_THAT(of_thicknesses("[1, 'thin']"),
                ElementsAre(begin + "[2]: found \"thin\", allowed: " + number));
    EXPECT_THAT(of_thicknesses("[1, '2 kg']"), ElementsAre(HasSubstr("[2]: found \"2 kg\"")));
    EXPECT_THAT(of_thicknesses("[1, true]"), ElementsAre(begin + "[2]: found true, allowed: " + number));
    EXPECT_THAT(of_thicknesses("[1, [2]]"), ElementsAre(begin + "[2]: found an array, allowed: " + number));
    EXPECT_THAT(of_thicknesses("1e-3"), ElementsAre(begin + ": found 0.001, allowed: " + list));
    EXPECT_THAT(of_thicknesses("{}"), ElementsAre(begin + ": found a table, allowed: " + list));
    EXPECT_THAT(of_thicknesses("[1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,'x']"),
                ElementsAre(begin + ": found 17 entries, allowed: " + list));
    EXPECT_THAT(faults_in("[end]\nthickness_m = [1]"),
                ElementsAre("scene.toml:2: end.thickness_m: found an array, allowed: " + number));
    EXPECT_THAT(faults_in("[end]\nmaterials = ['pyrx']\nthicknesses_m = [1]"),
                ElementsAre(testing::AllOf(HasSubstr("end.materials[1]: found \"pyrx\""),
                                           HasSubstr("did you mean 'pyrex'?"))));
    EXPECT_THAT(faults_in("[end]\nmaterials = ['water']\nthicknesses_m = [1]"),
                ElementsAre(HasSubstr("end.materials[1]: found \"water\", a fluid")));
}

TEST(SceneLists, WithoutEntriesAreNotGiven) {
    const std::vector<SceneKey> keys(scene_keys().begin(), scene_keys().end());
    for (const SceneKey& key : keys) {
        if (!key.is_list()) {
            EXPECT_FALSE(with_values(Scene{}, {{key.name, Json::array()}})) << key.name;
            continue;
        }
        Scene scene;
        const SceneValue one = key.kind == ValueKind::word ? SceneValue("steel") : SceneValue(0.5);
        ASSERT_TRUE(key.set(scene, test::filled_with(key, one)));
        ASSERT_NE(scene, Scene{});
        EXPECT_EQ(parse_scene("", "x", std::vector{key.name + "=[]"}).value().scene, Scene{}) << key.name;
        EXPECT_EQ(with_values(scene, {{key.name, Json::array()}}).value(), Scene{}) << key.name;
        EXPECT_EQ(with_values(scene, {{key.name, "[]"}}).value(), Scene{}) << key.name;
        const auto empty = read_allowed(scene, key, "[ ]");
        EXPECT_EQ(toml_text(empty.value()), "[]");
        EXPECT_EQ(allowed_value(scene, key, *empty).value(), *empty);
    }
    const char* focused = "end.model = 'modal'\n[array]\nx_m = [0]\ny_m = [0]\nfocus_m = [0, 0, 1]";
    EXPECT_THAT(
        parse_scene(focused, "x", std::vector<std::string>{"array.focus_m=[]"}).value().scene.array.focus_m,
        IsEmpty());
    EXPECT_THAT(faults_in("[array]\nfocus_m = []\n[chain]\ndiameters_m = []"), IsEmpty());
    EXPECT_THAT(faults_in("[output]\npoints_m = [[]]"),
                ElementsAre(HasSubstr(
                    "output.points_m[1]: found 0 entries, allowed: a list [A, B, ...] of 3 entries")));
    EXPECT_THAT(faults_in(two_layers, {"end.thicknesses_m=[]"}), Not(IsEmpty()));
}

TEST(SceneLists, EntriesThatAListDoesNotHaveAreFaults) {
    const auto fault_of = [](const std::string& option, const char* text = two_layers) {
        const auto faults = faults_in(text, {option});
        return faults.size() == 1 ? faults.front() : "";
    };
    EXPECT_THAT(
        fault_of("end.thicknesses_m[3]=1"),
        HasSubstr(
            "end.thicknesses_m[3]: found entry 3, allowed: end.thicknesses_m[1] to end.thicknesses_m[2]"));
    EXPECT_THAT(fault_of("end.thicknesses_m[0]=1"),
                HasSubstr("found no entry, allowed: end.thicknesses_m[1]"));
    EXPECT_THAT(fault_of("end.thicknesses_m[]=1"), HasSubstr("found no entry"));
    EXPECT_THAT(fault_of("end.thicknesses_m[1][1]=1"),
                HasSubstr("end.thicknesses_m[1][1]: found an entry of a single value"));
    EXPECT_THAT(fault_of("end.radius_m[1]=1"),
                HasSubstr("end.radius_m[1]: found an entry of a single value, allowed: end.radius_m"));
    EXPECT_THAT(fault_of("end.thicknesses_m[1]=1", ""),
                HasSubstr("found entry 1, allowed: none: the scene does not give end.thicknesses_m"));
    EXPECT_THAT(fault_of("end.thicknesses_m[one]=1"), HasSubstr("allowed: section.key=value"));
    EXPECT_THAT(fault_of("end.thicknesses_m[1=1"), HasSubstr("allowed: section.key=value"));
    EXPECT_THAT(fault_of("end.thicknesses_m[2]=-1"), HasSubstr("end.thicknesses_m[2]: found -1"));
    EXPECT_THAT(fault_of("end.thicknesses_m[99999999999999999999]=1"), HasSubstr("found no entry"));
}

TEST(SceneLists, AnEntryOfAListThatIsNotGivenIsOneAfterTheOptionOfTheMessage) {
    const std::string three =
        "end.model = 'modal'\n[chain]\nspheres = 4\n[array]\nx_m = [0, 0.02, 0.04]\ny_m = [0, 0, 0]\n";
    for (const auto& [entry, list] :
         {std::pair<std::string, std::string>{"array.delays_s[2]", "array.delays_s=[0, 0, 0]"},
          {"array.preloads_n[3]", "array.preloads_n=[0.1, 0.1, 0.1]"},
          {"array.materials[1]", "array.materials=[aluminium, aluminium, aluminium]"},
          {"array.focus_m[3]", "array.focus_m=[0, 0, 0]"},
          {"chain.diameters_m[2]", "chain.diameters_m=[0.001, 0.001, 0.001, 0.001]"},
          {"output.points_m[2][3]", "output.points_m=[[0, 0, 0], [0, 0, 0]]"}}) {
        const std::string set = entry + (entry.starts_with("array.mat") ? "=steel" : "=1e-3");
        EXPECT_THAT(faults_in(three, {set}),
                    ElementsAre(testing::EndsWith("; first give the whole list, as '" + list + "'")));
        EXPECT_THAT(faults_in(three, {list, set}), IsEmpty());
    }
    for (const char* entry :
         {"array.delays_s[4]", "array.focus_m[4]", "chain.diameters_m[5]", "end.materials[1]"}) {
        EXPECT_THAT(faults_in(three, {std::string(entry) + "=1e-3"}),
                    ElementsAre(testing::EndsWith("; first give the whole list")))
            << entry;
    }
    EXPECT_THAT(faults_in("", {"array.delays_s[1]=0"}), ElementsAre(testing::EndsWith("the whole list")));
}

TEST(SceneLists, HaveUnitsAtEachNumberButZeroOrAtNone) {
    EXPECT_THAT(
        faults_in(two_layers, {"end.thicknesses_m=[0.2, 0.5mm]"}),
        testing::Contains(HasSubstr("end.thicknesses_m: found \"0.2\" beside a number with a unit, allowed: "
                                    "a unit after each number but 0")));
    EXPECT_THAT(faults_in("", {"output.points_m=[[0, 0, 5mm], [0, 8, 5mm]]"}),
                testing::Contains(HasSubstr("output.points_m[2]: found \"8\"")));
}

TEST(SceneLists, LayersHaveAMaterialAndAThicknessEach) {
    EXPECT_THAT(
        faults_in("[end]\nmaterials = ['pyrex']"),
        ElementsAre(HasSubstr(
            "end.thicknesses_m: found nothing with end.materials of 1, allowed: 1, one for each layer")));
    EXPECT_THAT(faults_in("[end]\nthicknesses_m = [1]"),
                ElementsAre(HasSubstr("end.materials: found nothing with end.thicknesses_m of 1")));
    EXPECT_THAT(faults_in(two_layers, {"end.thicknesses_m=[1]"}),
                ElementsAre(HasSubstr("end.thicknesses_m: found 1 entry with end.materials of 2")));
    EXPECT_THAT(faults_in(two_layers, {"end.loss_factors=[0.1]"}),
                ElementsAre(HasSubstr("end.loss_factors: found 1 entry with")));
    EXPECT_THAT(faults_in("", {"end.loss_factors=[0.1]"}),
                ElementsAre(HasSubstr("allowed: none, or as many entries of end.materials")));
    EXPECT_THAT(faults_in(two_layers, {"end.loss_factors=[0.1, 0.2]"}), IsEmpty());
}

TEST(SceneLists, AnEntryIsAKeyOfItsOwn) {
    Scene scene = layered_scene();
    const SceneKey entry = scene_key_named(scene, "end.thicknesses_m[2]").value();
    EXPECT_FALSE(entry.is_list());
    EXPECT_EQ(entry.allowed(), "a number from 1e-09 to 10 m");
    EXPECT_EQ(entry.value(scene), SceneValue(5e-4));
    EXPECT_TRUE(entry.set(scene, 1e-3));
    EXPECT_THAT(scene.end.thicknesses_m, ElementsAre(2e-4, 1e-3));
    EXPECT_FALSE(entry.set(scene, std::nullopt));
    EXPECT_FALSE(entry.set(scene, std::string("thin")));
    EXPECT_EQ(value_fault(scene, entry, -1.0)->key, "end.thicknesses_m[2]");
    Scene without;
    EXPECT_FALSE(entry.set(without, 1e-3));
    EXPECT_EQ(entry.value(without), std::nullopt);
    EXPECT_EQ(without, Scene{});
}

TEST(SceneLists, PointsAreReadCheckedAndSetByTheirCoordinates) {
    const std::string modal = "[end]\nmodel = 'modal'\n[output]\npoints_m = ";
    Scene scene = parse_scene(modal + "[[0, 0, 0.01], ['3 mm', -1e-3, 0]]", "scene.toml").value().scene;
    EXPECT_THAT(scene.output.points_m, ElementsAre(std::array{0.0, 0.0, 0.01}, std::array{3e-3, -1e-3, 0.0}));
    EXPECT_TRUE(scene_key_named(scene, "output.points_m[2][3]")->set(scene, 0.02));
    EXPECT_EQ(scene.output.points_m[1][2], 0.02);
    EXPECT_THAT(faults_in(modal + "[[0, 0, 0.01], [0, 0, -1e-9]]"),
                ElementsAre(HasSubstr("output.points_m[2][3]: found -1e-09, allowed: at least 0")));
    EXPECT_THAT(faults_in(modal + "[[0, 0, 0.01], [0, 1]]"),
                ElementsAre(HasSubstr(
                    "output.points_m[2]: found 2 entries, allowed: a list [A, B, ...] of 3 entries")));
    EXPECT_THAT(faults_in(modal + "[0, 0, 0.01]"), Not(IsEmpty()));
    EXPECT_THAT(faults_in(modal + "[[0, 0, 10]]", {"output.sample_rate_hz=1e12"}),
                testing::Contains(HasSubstr("output.points_m[1]: found 10 m from the plate's centre")));
}

TEST(SceneLists, JsonHasThemBothWaysAndLeavesOutThoseThatAreNotGiven) {
    const Scene scene = layered_scene();
    const Json json = scene_json(scene);
    EXPECT_EQ(json["end"]["thicknesses_m"], Json({2e-4, 5e-4}));
    EXPECT_EQ(scene_of_json(json).value(), scene);
    EXPECT_FALSE(scene_json(Scene{})["end"].contains("thicknesses_m"));
    EXPECT_EQ(scene_of_json(scene_json(Scene{})).value(), Scene{});

    const auto changed =
        with_values(scene, {{"end.thicknesses_m[1]", "0.3 mm"}, {"end.materials[2]", "pyrex"}});
    EXPECT_THAT(changed.value().end.thicknesses_m, ElementsAre(3e-4, 5e-4));
    EXPECT_THAT(changed.value().end.materials, ElementsAre("aluminium", "pyrex"));
    const Json change{
        {"end.thicknesses_m[1]", 1}, {"end.materials", {"pyrex"}}, {"end.loss_factors", "[0.1, 0.2]"}};
    const Json was = values_of_keys(scene, change);
    EXPECT_EQ(was, Json({{"end.thicknesses_m", {2e-4, 5e-4}},
                         {"end.materials", {"aluminium", "acrylic"}},
                         {"end.loss_factors", nullptr}}));
    EXPECT_EQ(with_values(with_values(scene, change).value(), was).value(), scene);
    // a list that is taken back has no entries to take back
    const Json none = values_of_keys(Scene{}, change);
    EXPECT_TRUE(with_values(scene, none).value().end.thicknesses_m.empty());
}

TEST(SceneLists, FaultsOfJsonNameTheEntry) {
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m", {1e-3, -1}}}),
                ElementsAre(HasSubstr("end.thicknesses_m[2]: found -1")));
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m", {1e-3, nullptr}}}),
                ElementsAre(HasSubstr("end.thicknesses_m[2]: found null")));
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m", {1e-3, {2}}}}),
                ElementsAre(HasSubstr("end.thicknesses_m[2]: found [2]")));
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m", std::vector<int>(100'000, 1)}}),
                ElementsAre(HasSubstr("found 100000 entries")));
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m", 1}}),
                ElementsAre(HasSubstr("found 1, allowed: a list [A, B, ...] of at most 16")));
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m[3]", 1}}),
                ElementsAre(HasSubstr("end.thicknesses_m[3]: found entry 3")));
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m[1]", nullptr}}),
                ElementsAre(HasSubstr("end.thicknesses_m[1]: found null")));
    EXPECT_THAT(faults_of_values({{"end.thicknesses_m", "[1, 2"}}),
                ElementsAre(HasSubstr("found \"[1, 2\"")));
}

TEST(SceneLists, TheirSchemaHasTheBoundsOfEntriesAndNeedsNoList) {
    const Json end = scene_schema()["properties"]["end"];
    const Json& thicknesses = end["properties"]["thicknesses_m"];
    EXPECT_EQ(thicknesses["type"], Json({"array", "null"}));
    EXPECT_EQ(thicknesses["maxItems"], 16);
    EXPECT_EQ(thicknesses["items"], Json({{"type", "number"}, {"minimum", 1e-9}, {"maximum", 10.0}}));
    EXPECT_EQ(thicknesses["default"], nullptr);
    EXPECT_EQ(end["properties"]["thickness_m"]["replaced_by"], "end.thicknesses_m");
    EXPECT_EQ(std::ranges::count(end["required"], Json("thicknesses_m")), 0);
    const Json described = described_values(layered_scene(), {"end.materials", "end.materials[1]"}).value();
    EXPECT_EQ(described["end.materials"]["kind"], "list");
    EXPECT_EQ(described["end.materials"]["value"], Json({"aluminium", "acrylic"}));
    EXPECT_EQ(described["end.materials[1]"]["kind"], "word");
    EXPECT_EQ(described["end.materials[1]"]["value"], "aluminium");
}

TEST(SceneLists, AHashDependsOnTheEntriesAndOnNothingWithoutLists) {
    Scene scene = layered_scene();
    const std::string hash = scene_hash(scene);
    EXPECT_NE(hash, scene_hash(Scene{}));
    scene.end.thicknesses_m[1] = std::nextafter(5e-4, 1);
    EXPECT_NE(scene_hash(scene), hash);
    EXPECT_EQ(parse_scene(to_toml(scene), "x").value().scene, scene);
}

TEST(SceneLists, ReplacedKeysHaveNoEffect) {
    const auto has_effect = [](const Scene& scene, const char* name) {
        return scene_key_named(scene, name)->has_effect(scene);
    };
    EXPECT_TRUE(has_effect(Scene{}, "end.thickness_m"));
    EXPECT_FALSE(has_effect(layered_scene(), "end.thickness_m"));
    EXPECT_FALSE(has_effect(layered_scene(), "end.material"));
}

TEST(SceneLists, LongListsOfDecimalsFitIntoALine) {
    std::string text = "[end]\nmaterials = [";
    std::string thicknesses = "]\nthicknesses_m = [";
    for (int i = 0; i < 16; ++i) {
        text += "'pyrex', ";
        thicknesses += "0.0001, ";
    }
    EXPECT_THAT(faults_in(text + thicknesses + "] # " + std::string(16, '.')), IsEmpty());
    std::string dotted = "a";
    for (int i = 0; i < 33; ++i) {
        dotted += ".a";
    }
    EXPECT_THAT(faults_in(dotted + " = 1"), ElementsAre(HasSubstr("more than 32 dots")));
    EXPECT_THAT(faults_in("',,'." + dotted + " = 1"), ElementsAre(HasSubstr("more than 32 dots")));
}

TEST(ListsOfPoints, AreReadAndJudgedCoordinateByCoordinate) {
    const SceneKey key = points_key();
    const Scene scene;
    const auto read = [&](const char* text) {
        const auto value = read_allowed(scene, key, text);
        return value ? value_text(*value) : value.error().message();
    };
    EXPECT_EQ(read("[[0, 0, 10mm], [1e-3, -2e-3, 5]]"), "[[0, 0, 0.01], [0.001, -0.002, 5]]");
    EXPECT_EQ(toml_text(read_text(key, "[[0, -1, 2]]").value()), "[[0.0, -1.0, 2.0]]");
    EXPECT_EQ(read("[[0, 0, 1], [0, 0]]"),
              "output.points_m[2]: found 2 entries, allowed: a list [A, B, ...] of 3 entries, each a number "
              "from -10 to 10 m");
    EXPECT_EQ(read("[[0, 0, 1], [0, 0, 11]]"),
              "output.points_m[2][3]: found 11, allowed: a number from -10 to 10 m");
    EXPECT_THAT(read("[1, 2, 3]"),
                HasSubstr("output.points_m[1]: found \"1\", allowed: a list [A, B, ...] of 3 entries"));
    EXPECT_THAT(
        read("[[0, 0, 1]"),
        HasSubstr(
            "output.points_m: found \"[[0, 0, 1]\", allowed: a list [A, B, ...] of at most 1000000 entries"));
    const auto toml = toml_value("[[0, 0, 1], [0, '1 mm', 2.5]]");
    ASSERT_TRUE(toml);
    EXPECT_EQ(value_text(value_of(key, *toml).value()), "[[0, 0, 1], [0, 0.001, 2.5]]");
    EXPECT_EQ(value_of(key, *toml_value("[[0, 0, [1]]]")).error().key, "output.points_m[1][3]");
}

}  // namespace
}  // namespace hertzline
