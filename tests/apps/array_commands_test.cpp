// Commands on an array of chains, as their users see them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::string> three_in_a_row{"--set", "array.x_m=[0,12mm,24mm]",
                                              "--set", "array.y_m=[0,0,0]",
                                              "--set", "array.focus_m=[12mm,0,30mm]",
                                              "--set", "output.duration_s=60us",
                                              "--set", "output.points_m=[[12mm,0,30mm],[20mm,0,30mm]]"};

/// Words of a command on three chains.
std::vector<std::string> on_an_array(std::vector<std::string> words,
                                     const std::vector<std::string>& more = {}) {
    words.insert(words.end(), three_in_a_row.begin(), three_in_a_row.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST(ArrayCommands, ARunHasAColumnForEachElement) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.csv");
    const Outcome run = hertzline(
        on_an_array({"run", "wet-vitreous-carbon", "--json", "--columns", "v_last,p_points", "-o", file}));
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(contents(file),
                StartsWith("t_s,v_last_1_m_per_s,v_last_2_m_per_s,v_last_3_m_per_s,p_1_pa,p_2_pa\n"));
    EXPECT_EQ(run.json()["elements"], 3);
    EXPECT_EQ(run.json()["peaks_p_points_pa"].size(), 2U);
    EXPECT_GT(run.json()["focal_gain"].get<double>(), 1);
    const Outcome again = hertzline({"run", file, "--json"});
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(again.json()["peaks_p_points_pa"], run.json()["peaks_p_points_pa"])
        << "the recording holds the array";
}

TEST(ArrayCommands, CheckGivesNoStableStepThatItHasNotMeasured) {
    const Outcome check = hertzline(on_an_array({"check", "wet-vitreous-carbon", "--json"}));
    ASSERT_EQ(check.status, 0) << check.err;
    EXPECT_TRUE(check.json().contains("step_s"));
    EXPECT_FALSE(check.json().contains("largest_stable_step_s"));
}

TEST(ArrayCommands, CheckJudgesTheElementsThatThereAre) {
    const auto checked = [](const std::string& setting) {
        return hertzline(on_an_array({"check", "wet-vitreous-carbon", "--json"}, {"--set", setting})).json();
    };
    const json steel = checked("chain.material=steel");
    const json steel_elements = checked("array.materials=[steel]");
    for (const char* name : {"sphere_mass_kg", "horn_contact_stiffness_n_per_m1_5",
                             "sphere_contact_peak_pressure_pa", "fastest_static_hz"}) {
        EXPECT_EQ(steel_elements[name], steel[name]) << name;
    }
    EXPECT_NE(steel["sphere_mass_kg"], checked("chain.tolerance=0")["sphere_mass_kg"]);
    const Words last{"--set", "array.preloads_n=[0.1,0.1,60]"};
    EXPECT_THAT(hertzline(on_an_array({"check", "wet-vitreous-carbon"}, last)).err,
                testing::ContainsRegex("contacts press harder .*sphere - sphere [0-9]{4,} MPa at rest"));
    EXPECT_THAT(hertzline(on_an_array({"check", "wet-vitreous-carbon"},
                                      {"--set", "array.materials=[aluminium,aluminium,acrylic]"}))
                    .err,
                HasSubstr("the strength of acrylic is not known"));
}

TEST(ArrayCommands, OneSentenceSaysWhichElementsDifferInNumbers) {
    const auto told = [](const std::string& preloads) {
        return hertzline(
                   on_an_array({"check", "wet-vitreous-carbon"}, {"--set", "array.preloads_n=" + preloads}))
            .err;
    };
    EXPECT_THAT(told("[0.1,300,400]"),
                testing::ContainsRegex(
                    "element 2: the preload bends the disc by .*\\(and another with other numbers\\)"));
    EXPECT_THAT(told("[300,300,300]"), testing::Not(HasSubstr("element 1: the preload bends")));
    EXPECT_THAT(told("[0.1,300,0.1]"), testing::ContainsRegex("element 2: the preload bends[^(]*\n"));
    EXPECT_THAT(told("[300,0.1,300]"),
                testing::ContainsRegex("element 1: the preload bends.*\\(and another\\)"));
}

TEST(ArrayCommands, OutputsOfEachSphereAreRefused) {
    const TemporaryFolder folder;
    const Outcome run =
        hertzline(on_an_array({"run", "wet-vitreous-carbon", "--all", "-o", folder.file("a.csv")}));
    EXPECT_EQ(run.status, 2);
    EXPECT_THAT(run.err, HasSubstr("--all"));
}

TEST(ArrayCommands, ASweepVariesAnElement) {
    const TemporaryFolder folder;
    const std::string file = folder.file("s.csv");
    const Outcome sweep = hertzline(
        on_an_array({"sweep", "wet-vitreous-carbon", "--vary", "array.preloads_n[2]=0.1,0.4", "-o", file},
                    {"--set", "array.preloads_n=[0.1,0.1,0.1]"}));
    ASSERT_EQ(sweep.status, 0) << sweep.err;
    EXPECT_THAT(contents(file), HasSubstr("array.preloads_n[2],status,estimated_error"));
    EXPECT_THAT(contents(file), HasSubstr("focal_gain"));
}

TEST(ArrayCommands, AFieldIsThatOfAllElements) {
    const TemporaryFolder folder;
    const Outcome field = hertzline(on_an_array({"field", "wet-vitreous-carbon", "--json", "--plane",
                                                 "x=0,12mm,24mm,z=30mm", "-o", folder.file("f.csv")}));
    ASSERT_EQ(field.status, 0) << field.err;
    EXPECT_EQ(field.json()["points"], 3);
    const Outcome run = hertzline(on_an_array({"run", "wet-vitreous-carbon", "--json"}));
    const Outcome there =
        hertzline(on_an_array({"run", "wet-vitreous-carbon", "--json"},
                              {"--set", "output.points_m=[[0,0,0.03],[0.012,0,0.03],[0.024,0,0.03]]"}));
    const auto peaks = there.json()["peaks_p_points_pa"].get<std::vector<double>>();
    ASSERT_EQ(peaks.size(), 3U);
    EXPECT_NEAR(field.json()["largest_peak_pa"].get<double>(), *std::ranges::max_element(peaks),
                1e-3 * peaks[0]);
    EXPECT_EQ(run.json()["peaks_p_points_pa"].size(), 2U);
}

TEST(ArrayCommands, TheFieldOfAFocusedArrayTellsAndMarksItsFocus) {
    const TemporaryFolder folder;
    const std::string file = folder.file("f.h5");
    const auto drawn = [&](const std::string& plane) {
        const Outcome field =
            hertzline(on_an_array({"field", "wet-vitreous-carbon", "--json", "--plane", plane, "-o", file},
                                  {"--set", "array.focus_m=[11mm,0,30mm]"}));
        EXPECT_EQ(field.status, 0) << field.err;
        EXPECT_EQ(field.json()["near_focus_m"][0], 0.012);
        EXPECT_EQ(field.json()["near_focus_m"][2], 0.03);
        EXPECT_LE(field.json()["peak_near_focus_pa"], field.json()["largest_peak_pa"]);
        EXPECT_GT(field.json()["peak_near_focus_pa"], 0);
        EXPECT_EQ(hertzline({"plot", file, "-o", folder.file("f.svg")}).status, 0);
        return contents(folder.file("f.svg"));
    };
    EXPECT_THAT(drawn("x=0,12mm,24mm,z=30mm"), HasSubstr("<!-- focus -->"));
    EXPECT_THAT(drawn("x=0,12mm,24mm,z=20mm,30mm"), HasSubstr("<!-- focus -->"));
    EXPECT_THAT(drawn("x=0,12mm,24mm,y=1mm,z=20mm,30mm"), testing::Not(HasSubstr("<!-- focus -->")));
}

}  // namespace
}  // namespace hertzline::test
