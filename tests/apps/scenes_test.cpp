// hertzline scenes: the list, and a scene with every default resolved.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(Scenes, ListsEveryShippedSceneWithItsDescription) {
    const Outcome text = hertzline({"scenes"});
    const auto list = hertzline({"scenes", "--json"}).json();
    EXPECT_EQ(text.status, 0);
    ASSERT_EQ(list.size(), shipped_scenes().size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        EXPECT_EQ(list[i]["name"], shipped_scenes()[i].name);
        EXPECT_EQ(list[i]["description"], shipped_scenes()[i].description);
        EXPECT_THAT(text.out, HasSubstr(std::string(shipped_scenes()[i].description)));
    }
}

TEST(Scenes, PrintsAFileThatRunsTheSame) {
    const TemporaryFolder folder;
    const Outcome printed = hertzline({"scenes", "paper-pyrex", "--set", "drive.cycles=5"});
    ASSERT_EQ(printed.status, 0) << printed.err;
    EXPECT_THAT(printed.out, HasSubstr("estimated relative error"));
    EXPECT_THAT(printed.out, HasSubstr("step_s = "));
    EXPECT_THAT(printed.out, HasSubstr("integrator = "));
    write_text(folder.file("pyrex.toml"), printed.out);
    const auto again = hertzline({"run", folder.file("pyrex.toml"), "--json"}).json();
    const auto original = hertzline({"run", "paper-pyrex", "--set", "drive.cycles=5", "--json"}).json();
    EXPECT_EQ(again["scene_hash"], original["scene_hash"]);
    EXPECT_EQ(again["peak_v_out_m_per_s"], original["peak_v_out_m_per_s"]);
}

TEST(Scenes, PrintsAFileThatGivesTheSameBits) {
    const TemporaryFolder folder;
    // steps that no short decimal number holds, and steps that the program chooses
    for (const Words& numerics : {Words{"integrator=taylor8", "step_s=0.4567890123456789e-6"},
                                  Words{"integrator=taylor12", "step_s=0.2718281828459045e-6"},
                                  Words{"integrator=taylor8", "accuracy=3e-5"},
                                  Words{"integrator=taylor12", "accuracy=3e-9"}, Words{"accuracy=2e-6"}}) {
        Words settings;
        for (const std::string& setting : numerics) {
            settings.insert(settings.end(), {"--set", "numerics." + setting});
        }
        const auto with_settings = [&](Words words) {
            words.insert(words.end(), settings.begin(), settings.end());
            return hertzline(words);
        };
        write_text(folder.file("printed.toml"), with_settings({"scenes", "paper-acrylic"}).out);
        const Outcome original =
            with_settings({"run", "paper-acrylic", "--json", "--all", "-o", folder.file("original.csv")});
        const Outcome again = hertzline(
            {"run", folder.file("printed.toml"), "--json", "--all", "-o", folder.file("again.csv")});
        ASSERT_EQ(original.status, 0) << original.err;
        ASSERT_EQ(again.status, 0) << again.err;
        EXPECT_EQ(contents(folder.file("again.csv")), contents(folder.file("original.csv")))
            << numerics.front();
        for (const char* name : {"step_s", "integrator", "estimated_error", "steps", "scene_hash"}) {
            EXPECT_EQ(again.json()[name], original.json()[name]) << name;
        }
    }
}

TEST(Scenes, SaysOfAGivenStepThatItWasGiven) {
    const Outcome printed = hertzline({"scenes", "paper-wall", "--set", "numerics.step_s=400e-9"});
    EXPECT_THAT(printed.out, HasSubstr("step_s was given: estimated relative error"));
}

TEST(Scenes, PrintsJsonWithEveryDefaultResolved) {
    const auto scene = hertzline({"scenes", "paper-wall", "--json"}).json();
    EXPECT_EQ(scene["end"]["kind"], "wall");
    EXPECT_EQ(scene["drive"]["frequency_hz"], 73e3);
    EXPECT_TRUE(scene["numerics"]["step_s"].is_number());
    EXPECT_TRUE(scene["numerics"]["integrator"].is_string());
}

TEST(Scenes, LeavesOpenWhatTheProgramChoosesWhereItIsAsked) {
    const TemporaryFolder folder;
    const auto scene =
        hertzline({"scenes", "paper-wall", "--set", "numerics.accuracy=1e-6", "--unresolved", "--json"})
            .json();
    EXPECT_EQ(scene["end"]["kind"], "wall");
    EXPECT_TRUE(scene["numerics"]["step_s"].is_null());
    EXPECT_TRUE(scene["numerics"]["integrator"].is_null());
    EXPECT_EQ(scene["numerics"]["accuracy"], 1e-6);
    const Outcome text = hertzline({"scenes", "paper-wall", "--unresolved"});
    write_text(folder.file("open.toml"), text.out);
    EXPECT_EQ(hertzline({"scenes", folder.file("open.toml"), "--json"}).json(),
              hertzline({"scenes", "paper-wall", "--json"}).json());
    const Outcome wrong = hertzline({"scenes", "paper-wall", "--unresolved", "--set", "chain.preload_n=-1"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("chain.preload_n: found -1, allowed: a number from 0"));
}

TEST(Scenes, ThatOfARecordingIsTheOneThatWasAskedFor) {
    const TemporaryFolder folder;
    const std::string file = folder.file("r.h5");
    ASSERT_EQ(hertzline({"run", "paper-wall", "--set", "numerics.accuracy=1e-3", "-o", file}).status, 0);
    const auto numerics = hertzline({"scenes", file, "--unresolved", "--json"}).json()["numerics"];
    EXPECT_EQ(numerics["accuracy"], 1e-3);
    EXPECT_TRUE(numerics["step_s"].is_null() && numerics["integrator"].is_null());
    const Words changed{"--set", "drive.amplitude_m=10um", "--json"};
    const auto of_recording = hertzline(with({"check", file}, changed)).json();
    const auto of_scene =
        hertzline(with({"check", "paper-wall", "--set", "numerics.accuracy=1e-3"}, changed)).json();
    EXPECT_EQ(of_recording["step_s"], of_scene["step_s"]) << "steps that were chosen are chosen again";
    const Outcome wrong = hertzline({"check", file, "--set", "chain.spheres=1", "--set",
                                     "chain.impact_velocity_m_per_s=0.1", "--set", "chain.impact_spheres=3"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, Not(HasSubstr("r.h5:"))) << "a line of a text that no file has";
    const std::string again = folder.file("again.h5");
    ASSERT_EQ(hertzline({"run", "paper-wall", "--set", "numerics.step_s=3e-7", "-o", again}).status, 0);
    EXPECT_EQ(hertzline({"check", again, "--json"}).json()["step_s"], 3e-7) << "one that was given is kept";
}

TEST(Scenes, OneWithItsStepIsStillWarnedOfChaos) {
    const TemporaryFolder folder;
    const std::string file = folder.file("my.toml");
    write_text(file, hertzline({"scenes", "paper-wall"}).out);
    const Words undamped{file, "--set", "chain.damping_kg_per_s=0"};
    for (const char* command : {"check", "run"}) {
        EXPECT_THAT(
            hertzline(with({command}, undamped)).err,
            AllOf(HasSubstr("by the step that the scene gives"), HasSubstr("amplifies rounding errors")))
            << command;
    }
    EXPECT_THAT(hertzline({"sweep", file, "--vary", "chain.damping_kg_per_s=0,0.1", "--json"}).out,
                HasSubstr("\"chaotic\""));
    EXPECT_THAT(hertzline(with({"run"}, {file})).err, Not(HasSubstr("estimated error")));
}

}  // namespace

}  // namespace hertzline::test
