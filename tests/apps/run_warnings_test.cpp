// Warnings of hertzline run, check and stream.

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/program.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

TEST(Run, WarnsOfARecordThatIsTooShortForItsSpectrum) {
    const Outcome acrylic = hertzline({"run", "paper-acrylic"});
    EXPECT_THAT(acrylic.err, ContainsRegex("warning: .*still rings at [0-9.]+ % of its peak"));
    const Outcome begun = hertzline({"run", "paper-wall", "--set", "drive.frequency_hz=73"});
    EXPECT_THAT(begun.err, ContainsRegex("warning: .*within the burst, which ends at 0.342"));
    const Outcome coarse = hertzline({"run", "paper-wall", "--set", "output.sample_rate_hz=1e5"});
    EXPECT_THAT(coarse.err, ContainsRegex("warning: harmonics above half the sample rate"));
}

TEST(Run, JsonHasItsWarnings) {
    const Outcome outcome = hertzline({"run", "paper-acrylic", "--json", "--set", "end.modes=2"});
    const auto warnings = outcome.json()["warnings"];
    ASSERT_GE(warnings.size(), 3U);
    std::string all;
    for (const auto& text : warnings) {
        EXPECT_THAT(outcome.err, HasSubstr(text.get<std::string>()));
        all += text.get<std::string>() + '\n';
    }
    EXPECT_THAT(all, AllOf(HasSubstr("end.modes has no effect"), HasSubstr("still rings"),
                           HasSubstr("contacts press harder")));
    EXPECT_EQ(hertzline({"run", "paper-wall"}).out.find("warnings"), std::string::npos);
}

TEST(Run, CheckAndStreamWarnOnceOfASceneBeyondTheModel) {
    const std::vector<Words> commands{
        {"run"}, {"check"}, {"stream", "--duration", "1e-3", "--bind", "tcp://127.0.0.1:*"}};
    for (Words words : commands) {
        words.insert(words.end(), {"paper-vitreous-carbon", "--set", "end.thickness_m=0.5"});
        const std::string err = hertzline(words).err;
        const auto first = err.find("were millimetres meant?");
        EXPECT_NE(first, std::string::npos) << words[0];
        EXPECT_EQ(err.find("were millimetres meant?", first + 1), std::string::npos) << words[0];
        EXPECT_THAT(err, HasSubstr("no thin plate"));
    }
}

TEST(Run, AndStreamReadTheRecordOfTheDriveOnce) {
    const TemporaryFolder folder;
    std::string record = "t_s,x_um\n";
    for (int i = 0; i < 100; ++i) {
        record +=
            fmt::format("{:.1e},{:.6f}\n", 1e-6 * i, std::sin(0.5 * i) * std::pow(std::sin(0.0314 * i), 4));
    }
    write_text(folder.file("horn.csv"), record);
    write_text(folder.file("device.toml"), "[drive]\nkind = 'file'\nfile = 'horn.csv'\nscale = 2e-6\n");
    write_text(folder.file("changes.json"), R"([{"sample": 50, "set": {"chain.preload_n": 0.2}}])");
    const std::string told = folder.file("device.toml") + ": drive.file: x_um is in um; drive.scale";
    for (const Words& words : {Words{"check"}, Words{"run", "--changes", folder.file("changes.json")},
                               Words{"stream", "--bind", "tcp://127.0.0.1:*", "--control",
                                     "tcp://127.0.0.1:*", "--duration", "1e-4"}}) {
        const Outcome outcome = hertzline(with(words, {folder.file("device.toml")}));
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const std::size_t first = outcome.err.find(told);
        ASSERT_NE(first, std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.err.find(told, first + 1), std::string::npos) << outcome.err;
    }
    EXPECT_THAT(hertzline({"run", folder.file("device.toml"), "--json"}).json()["warnings"].dump(),
                HasSubstr("x_um is in um; drive.scale"));
}

TEST(Check, NamesStiffnessWhereStepsAreFarTooShort) {
    const Outcome outcome = hertzline({"check", "paper-stream", "--set", "chain.damping_kg_per_s=1e9"});
    EXPECT_THAT(outcome.err, HasSubstr("the scene is too stiff: with its steps of"));
    EXPECT_THAT(outcome.err, Not(HasSubstr("amplifies rounding")));
}

TEST(Run, CheckAndStreamWarnOnceOfContactsBeyondTheirMaterials) {
    const auto warned = [](Words words, const std::string& strength) {
        const Words scene{"paper-wall",
                          "--set",
                          "materials.mine.youngs_modulus_pa=69e9",
                          "--set",
                          "materials.mine.poissons_ratio=0.33",
                          "--set",
                          "materials.mine.density=2700",
                          "--set",
                          "materials.mine.yield_strength_pa=" + strength,
                          "--set",
                          "chain.material=mine",
                          "--set",
                          "drive.material=mine"};
        words.insert(words.end(), scene.begin(), scene.end());
        const std::string err = hertzline(words).err;
        const auto first = err.find("contacts press harder than their materials bear: horn - sphere");
        EXPECT_TRUE(first == std::string::npos || err.find("press harder", first + 20) == std::string::npos);
        return first != std::string::npos;
    };
    for (const Words& words : std::vector<Words>{
             {"run"}, {"check"}, {"stream", "--duration", "1e-3", "--bind", "tcp://127.0.0.1:*"}}) {
        EXPECT_TRUE(warned(words, "5e8")) << words[0];  // beyond in motion only: 0.8 GPa at rest, 2.3 at most
        EXPECT_FALSE(warned(words, "1e10")) << words[0];
    }
}

TEST(Run, WarnsOfAnAccuracyThatNoStepIsShownToReach) {
    const Outcome outcome = hertzline({"run", "paper-wall", "--set", "numerics.accuracy=1e-15"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, ContainsRegex("warning: .*accuracy of 1e-15"));
    EXPECT_THAT(outcome.err, Not(HasSubstr("amplifies")));
}

TEST(Run, WarnsWhereTheMotionAmplifiesRoundingErrorsAndOnlyIfTheRunIsThatLong) {
    const Words words{"run", "sonic-vacuum", "--set", "chain.damping_kg_per_s=0", "--json"};
    const Outcome outcome = hertzline(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err,
                ContainsRegex("warning: .*requested accuracy of 0.0001; the motion amplifies rounding"));
    EXPECT_GT(outcome.json()["estimated_error"].get<double>(), 1e-4);
    Words brief = words;
    brief.insert(brief.end(), {"--set", "output.duration_s=2e-5"});
    const Outcome begun = hertzline(brief);
    EXPECT_THAT(begun.err, Not(HasSubstr("accuracy")));
    EXPECT_LE(begun.json()["estimated_error"].get<double>(), 1e-4);
}

}  // namespace

}  // namespace hertzline::test
