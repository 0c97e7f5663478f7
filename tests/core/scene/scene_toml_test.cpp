#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "tests/support/scene_texts.hpp"

namespace hertzline::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(SceneToml, AnEmptyTextIsThePapersScene) {
    EXPECT_EQ(scene_of(""), Scene{});
    EXPECT_EQ(scene_of("# nothing\r\n[drive]\n\n[materials]\n"), Scene{});
}

TEST(SceneToml, KeysReachTheirMembers) {
    const Scene scene = scene_of(R"(
[drive]
kind = "none"
material = "pyrex"
frequency_hz = 50e3
cycles = 10
amplitude_m = 1e-6
envelope = "tukey"
taper = 0.5
repetition_hz = 0
sweep_to_hz = 80e3
start_s = 1e-5
[chain]
material = "steel"
spheres = 7
diameter_m = 2e-3
materials = ["steel", "glass"]
diameters_m = [2e-3, 1e-3, 3e-3]
taper = 0.1
damping_kg_per_s = 0.1
preload_n = 1
tension = "clamped"
gravity_m_per_s2 = 9.81
holder_time_s = 1e-3
impact_velocity_m_per_s = -2
impact_spheres = 3
[end]
kind = "free"
material = "acrylic"
radius_m = 4e-3
thickness_m = 1e-3
stiffness_n_per_m = 1e5
preload = "as_printed"
[medium]
material = "oil"
[numerics]
integrator = "leapfrog"
step_s = 1e-9
[output]
sample_rate_hz = 1e6
duration_s = 1
frame_samples = 16
[materials.oil]
density_kg_per_m3 = 900
sound_speed_m_per_s = 1400
[materials.glass]
youngs_modulus_pa = 70e9
poissons_ratio = 0.2
density_kg_per_m3 = 2500
)");
    const Scene expected{
        {DriveKind::none, "pyrex", 50e3, 10, 1e-6, Envelope::tukey, 0.5, 0, 80e3, 1e-5},
        {"steel",
         7,
         2e-3,
         {"steel", "glass"},
         {2e-3, 1e-3, 3e-3},
         0.1,
         0.1,
         DampingLaw::dashpot,
         std::nullopt,
         std::nullopt,
         1,
         Tension::clamped,
         9.81,
         1e-3,
         -2,
         3},
        {EndKind::free, "acrylic", 4e-3, 1e-3, 1e5, PlatePreload::as_printed},
        {"oil"},
        {},
        {Integrator::leapfrog, 1e-9, std::nullopt, 0, std::nullopt},
        {1e6, 1, 16},
        {{"oil", Fluid{900, 1400}}, {"glass", Solid{70e9, 0.2, 2500}}},
    };
    EXPECT_EQ(scene, expected);
}

TEST(SceneToml, AMessageNamesFileLineKeyValueAndBound) {
    EXPECT_THAT(messages("[chain]\n\nspheres = 0\n"),
                ElementsAre("scene.toml:3: chain.spheres: found 0, allowed: an integer from 1 to 10000000"));
    EXPECT_THAT(
        messages("", {"chain.spheres=0"}),
        ElementsAre("--set chain.spheres=0: chain.spheres: found 0, allowed: an integer from 1 to 10000000"));
}

TEST(SceneToml, AllFaultsAreReportedInTheOrderOfTheirLines) {
    EXPECT_THAT(
        messages("[drive]\n"
                 "frequency_hz = 'fast'\n"  // wrong type
                 "colour = 'red'\n"         // unknown key
                 "envelope = 'han'\n"       // unknown word
                 "[ends]\n"                 // unknown section
                 "kind = 'wall'\n"
                 "[end]\n"
                 "thickness_m = -1\n"      // out of bounds
                 "material = 'cheese'\n",  // unknown material
                 {"chain.spheres=0", "nonsense"}),
        ElementsAre(StartsWith("scene.toml:2: drive.frequency_hz: found \"fast\", allowed: a number from"),
                    StartsWith("scene.toml:3: drive.colour: found an unknown key, allowed: one of kind"),
                    StartsWith("scene.toml:4: drive.envelope: found \"han\", allowed: one of \"hann\""),
                    StartsWith("scene.toml:5: ends: found an unknown section, allowed: one of drive"),
                    StartsWith("scene.toml:8: end.thickness_m: found -1"),
                    StartsWith("scene.toml:9: end.material: found \"cheese\""),
                    StartsWith("--set nonsense: found \"nonsense\", allowed: section.key=value"),
                    StartsWith("--set chain.spheres=0: chain.spheres: found 0")));
}

TEST(SceneToml, SlipsOfTheFingersBringASuggestion) {
    const auto suggests = [](std::string_view text, const std::string& key) {
        EXPECT_THAT(messages(text), ElementsAre(HasSubstr("did you mean '" + key + "'?"))) << text;
    };
    suggests("[chain]\nsphere = 6", "chain.spheres");
    suggests("[drive]\nfrequency = 73e3", "drive.frequency_hz");
    suggests("[chain]\ndamping = 0.1", "chain.damping_kg_per_s");
    suggests("[drive]\npreload_n = 0.1", "chain.preload_n");
    suggests("[drve]\ncycles = 3", "drive");
    suggests("cycles = 3", "drive.cycles");
    suggests("[end]\nkind = 'wal'", "wall");
    suggests("[end]\nmaterial = 'vitrous_carbon'", "vitreous_carbon");
    suggests("[materials.x]\nyoungs_modulus_pa=1e9\npoissons_ratio=0\ndensity=1e3\nsoundspeed_m_per_s=1",
             "sound_speed_m_per_s");
    EXPECT_THAT(messages("", {"chain.sphere=3"}), ElementsAre(HasSubstr("did you mean 'chain.spheres'?")));
    EXPECT_THAT(messages("[chain]\ncolour = 'red'"), ElementsAre(Not(HasSubstr("did you mean"))));
}

TEST(SceneToml, FloatsMayBeWrittenAsIntegersButNotIntegersAsFloats) {
    EXPECT_EQ(scene_of("[drive]\nfrequency_hz = 80_000").drive.frequency_hz, 80e3);
    EXPECT_THAT(
        messages("[chain]\nspheres = 6.0"),
        ElementsAre("scene.toml:2: chain.spheres: found 6.0, allowed: an integer from 1 to 10000000"));
    EXPECT_THAT(messages("[chain]\nspheres = 6.5"), ElementsAre(HasSubstr("found 6.5, allowed: an integer")));
    EXPECT_THAT(messages("[chain]\nspheres = 1e3"),
                ElementsAre(HasSubstr("found 1000.0, allowed: an integer")));
    EXPECT_THAT(messages("[chain]\nspheres = '6'"),
                ElementsAre(HasSubstr("found \"6\", allowed: an integer")));
}

TEST(SceneToml, InfinityAndNotANumberAreRefused) {
    for (const char* value : {"inf", "-inf", "nan", "+nan"}) {
        EXPECT_THAT(messages(std::string("[output]\nduration_s = ") + value),
                    ElementsAre(AllOf(StartsWith("scene.toml:2: output.duration_s: found "),
                                      HasSubstr("allowed: a number from 1e-12 to 1e+06 s"))));
        EXPECT_EQ(messages("", {std::string("output.duration_s=") + value}).size(), 1);
    }
    EXPECT_EQ(messages("[output]\nduration_s = 1e400").size(), 1);
}

TEST(SceneToml, ValuesOfOtherTypesAreNamed) {
    EXPECT_THAT(messages("[drive]\ncycles = true"), ElementsAre(HasSubstr("found true, allowed: a number")));
    EXPECT_THAT(messages("[drive]\ncycles = [1]"),
                ElementsAre(HasSubstr("found an array, allowed: a number")));
    EXPECT_THAT(messages("[drive]\ncycles = {x=1}"),
                ElementsAre(HasSubstr("found a table, allowed: a number")));
    EXPECT_THAT(messages("[drive]\ncycles.x = 1"),
                ElementsAre(HasSubstr("found a table, allowed: a number")));
    EXPECT_THAT(messages("[drive]\ncycles = 1979-05-27"), ElementsAre(HasSubstr("found a date or time")));
    EXPECT_THAT(messages("[drive]\nmaterial = 5"),
                ElementsAre(HasSubstr("found 5, allowed: the name of a solid")));
    EXPECT_THAT(messages("[drive]\nenvelope = 5"),
                ElementsAre(HasSubstr("found 5, allowed: one of \"hann\"")));
}

TEST(SceneToml, SectionsAreTables) {
    EXPECT_THAT(messages("drive = 5"), ElementsAre(HasSubstr("drive: found 5, allowed: a section, [drive]")));
    EXPECT_THAT(messages("[[drive]]\ncycles = 3"), ElementsAre(HasSubstr("drive: found an array")));
    EXPECT_THAT(messages("[chain.x]\ny = 1"), ElementsAre(HasSubstr("chain.x: found an unknown key")));
    EXPECT_THAT(messages("[materials]\nglass = 3"),
                ElementsAre(HasSubstr("allowed: a section, [materials.glass]")));
    EXPECT_EQ(scene_of("drive = {cycles = 3}\nchain.spheres = 2").chain.spheres, 2);
}

TEST(SceneToml, ASyntaxErrorHasItsLine) {
    EXPECT_THAT(messages("[drive]\ncycles = \n"),
                ElementsAre(StartsWith("scene.toml:2: found a syntax error in ")));
    EXPECT_THAT(messages("[drive]\ncycles = 1\ncycles = 2\n"),
                ElementsAre(StartsWith("scene.toml:3: found a syntax")));
    EXPECT_EQ(messages("[drive", {"chain.sphere=1", "chain.spheres=2"}).size(), 2);
}

TEST(SceneToml, OwnMaterialsMayBeSolidOrFluid) {
    const Scene scene = scene_of(
        "[chain]\nmaterial='ruby'\n[medium]\nmaterial='oil'\n"
        "[materials.ruby]\nyoungs_modulus_pa=4e11\npoissons_ratio=0.25\ndensity_kg_per_m3=3990\n"
        "[materials.oil]\ndensity=900\nsound_speed_m_per_s=1400\n");
    EXPECT_EQ(scene.materials.at("ruby"), Material(Solid{4e11, 0.25, 3990}));
    EXPECT_EQ(scene.materials.at("oil"), Material(Fluid{900, 1400}));
}

TEST(SceneToml, AnIncompleteOrMixedMaterialIsAFault) {
    EXPECT_THAT(
        messages("[materials.m]\nyoungs_modulus_pa=1e9\n"),
        ElementsAre(StartsWith("scene.toml:1: materials.m.poissons_ratio: found nothing, allowed: a number"),
                    StartsWith("scene.toml:1: materials.m.density_kg_per_m3: found nothing")));
    EXPECT_THAT(messages("[materials.m]\nsound_speed_m_per_s=1e3\n"),
                ElementsAre(StartsWith("scene.toml:1: materials.m.density_kg_per_m3: found nothing")));
    EXPECT_THAT(messages("[materials.m]\nyoungs_modulus_pa=1e9\nsound_speed_m_per_s=1e3\n"),
                ElementsAre(StartsWith("scene.toml:1: materials.m: found keys of a solid and of a fluid")));
    EXPECT_THAT(messages("[materials.m]\n"),
                ElementsAre(StartsWith("scene.toml:1: materials.m: found no material")));
    EXPECT_THAT(messages("[materials.m]\nsound_speed_m_per_s=1\ndensity=1\ndensity_kg_per_m3=1\n"),
                ElementsAre(HasSubstr("density or density_kg_per_m3, not both")));
    EXPECT_THAT(messages("[materials.'a b']\nsound_speed_m_per_s=1\ndensity=1\n"),
                ElementsAre(StartsWith(
                    "scene.toml:1: materials.\"a b\": found \"a b\", allowed: a name of 1 to 64")));
}

TEST(SceneToml, AFaultOfAMaterialIsNotReportedWhereItIsUsedToo) {
    EXPECT_EQ(messages("[end]\nmaterial='m'\n[materials.m]\n").size(), 1);
    EXPECT_EQ(
        messages("[end]\nmaterial='m'\n[materials.m]\nyoungs_modulus_pa='x'\npoissons_ratio=0\ndensity=1\n")
            .size(),
        1);
}

TEST(SceneToml, FaultsOfOwnMaterialsHaveTheirLine) {
    EXPECT_THAT(messages("[materials.m]\nyoungs_modulus_pa=1e9\npoissons_ratio=0.5\ndensity=-1\n"),
                ElementsAre(StartsWith("scene.toml:3: materials.m.poissons_ratio: found 0.5"),
                            StartsWith("scene.toml:4: materials.m.density_kg_per_m3: found -1")));
}

TEST(SceneToml, ANumberOfAnOptionNeedsNoDigitBeforeItsPoint) {
    const std::vector<std::string> options{"chain.preload_n=.2", "chain.impact_velocity_m_per_s=-.5"};
    const auto result = parse_scene("", "scene.toml", options);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->scene.chain.preload_n, 0.2);
    EXPECT_EQ(result->scene.chain.impact_velocity_m_per_s, -0.5);
}

TEST(SceneToml, AFaultThatShowsLaterHasItsPlace) {
    const std::vector<std::string> options{"chain.preload_n=2"};
    const auto result = parse_scene("[numerics]\nstep_s = 1e-5\n", "scene.toml", options);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->placed({"numerics.step_s", "1e-05", "less"}).message(),
              "scene.toml:2: numerics.step_s: found 1e-05, allowed: less");
    EXPECT_EQ(result->placed({"chain.preload_n", "2", "less"}).message(),
              "--set chain.preload_n=2: chain.preload_n: found 2, allowed: less");
    EXPECT_EQ(result->placed({"chain.spheres", "6", "less"}).message(),
              "scene.toml: chain.spheres: found 6, allowed: less");
}

TEST(SceneToml, HostileTextNeverReachesTheTerminal) {
    for (const auto& text :
         {"[drive]\nmaterial = \"\\u001b[2J\"", "[drive]\n\"\\u001b[2J\" = 1", R"(["\u001b"])",
          "\"\\u001b\" = 1\n\"\\u001b\" = 1", "[materials.\"\\u001b\"]\ndensity = 1"}) {
        EXPECT_THAT(messages(text), testing::Each(Not(HasSubstr("\x1B")))) << text;
        EXPECT_FALSE(messages(text).empty());
    }
    EXPECT_THAT(messages("", {"\x1B=1", "drive.material=\x1B"}), testing::Each(Not(HasSubstr("\x1B"))));
    EXPECT_LT(messages("[drive]\n" + std::string(60'000, 'x') + " = 1")[0].size(), 500);
}

}  // namespace
}  // namespace hertzline::test
