// hertzline run --changes: a scene that changes during the run.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/simulated_again.hpp"

namespace hertzline::test {

namespace {

using testing::HasSubstr;

TEST(ChangedRun, ChangesOfAFileAreMadeInARun) {
    const TemporaryFolder folder;
    write_text(
        folder.file("changes.json"),
        R"([{"sample": 1000, "set": {"drive.amplitude_m": 1e-6}}, {"sample": 2000, "set": {"chain.preload_n": 0.2}}])");
    const Words words{"run",   "paper-stream",          "--set", "output.sample_rate_hz=1e6",
                      "--set", "output.duration_s=3e-3"};
    const auto v_out = [&](const Words& more, const std::string& file) {
        const Outcome run = hertzline(with(with(words, more), {"-o", file}));
        EXPECT_EQ(run.status, 0) << run.err;
        return csv_of(file).at("v_out_m_per_s");
    };
    const auto plain = v_out({}, folder.file("plain.csv"));
    const auto changed = v_out({"--changes", folder.file("changes.json")}, folder.file("changed.csv"));
    const auto anew =
        v_out({"--set", "chain.preload_n=0.2", "--set", "drive.amplitude_m=1e-6"}, folder.file("anew.csv"));
    ASSERT_EQ(changed.size(), plain.size());
    EXPECT_TRUE(std::equal(plain.begin(), plain.begin() + 1000, changed.begin()));
    EXPECT_FALSE(std::equal(plain.begin() + 1000, plain.begin() + 2000, changed.begin() + 1000));
    EXPECT_TRUE(std::equal(anew.begin(), anew.begin() + 1000, changed.begin() + 2000));
    for (const std::string ending : {".csv", ".wav", ".h5", ".npy", ".sigmf-meta"}) {
        const std::string recording = folder.file("r" + ending);
        hertzline(with(words, {"--changes", folder.file("changes.json"), "-o", recording}));
        const std::string again = folder.file("again.csv");
        const Outcome outcome = hertzline({"run", recording, "-o", again});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(csv_of(again).at("v_out_m_per_s"), changed) << ending;
    }
    const Outcome wrong = hertzline(with(words, {"--changes", folder.file("plain.csv")}));
    EXPECT_EQ(wrong.status, 2);
}

TEST(ChangedRun, ChangesThatCannotBeMadeAreFaults) {
    const TemporaryFolder folder;
    const auto fault = [&](const std::string& list) {
        write_text(folder.file("changes.json"), list);
        const Outcome run =
            hertzline({"run", "paper-vitreous-carbon", "--changes", folder.file("changes.json")});
        EXPECT_EQ(run.status, 2) << list;
        return run.err;
    };
    EXPECT_THAT(fault(R"([{"sample": 5001, "set": {"drive.amplitude_m": 2e-6}}])"),
                HasSubstr("found a change from sample 5001 on, allowed: up to 5000"));
    EXPECT_THAT(fault(R"([{"sample": 10, "set": {}}, {"sample": 20000, "set": {"chain.preload_n": 0.2}}])"),
                HasSubstr("allowed: up to 5000"));
    EXPECT_THAT(fault(R"([{"sample": 0, "set": {"chain.preload_n": 0.2}}])"),
                HasSubstr("allowed: a whole number from 1 to"));
    EXPECT_THAT(fault(R"([{"sample": 10, "set": {"chain.preload_n": 0.2}, "foo": 1}])"),
                HasSubstr("the member \"foo\""));
    EXPECT_THAT(fault(R"([{"sample": 1e300, "set": {}}])"), HasSubstr("sample: found"));
    EXPECT_THAT(fault(R"([{"sample": 10, "set": {"chain.preload_n": 0.2}, "motion": "goes on"}])"),
                HasSubstr("motion: found \"goes on\", but these keys restart the motion"));
    EXPECT_THAT(
        fault(
            R"([{"sample": 10, "set": {"chain.preload_n": -1}}, {"sample": 20, "set": {"drive.cycles": -2}}])"),
        testing::AllOf(HasSubstr("sample 10 on: chain.preload_n: found -1"),
                       HasSubstr("sample 20 on: drive.cycles: found -2")));
}

TEST(ChangedRun, TheDocumentsChangesChangeTheRun) {
    std::ifstream document(HERTZLINE_SOURCE_DIR "/apps/README.md");
    const std::string text{std::istreambuf_iterator<char>(document), {}};
    std::smatch scene;
    ASSERT_TRUE(std::regex_search(text, scene, std::regex("hertzline run (\\S+) --changes changes.json")));
    const std::size_t begin = text.find("    [{\"sample\"");
    ASSERT_NE(begin, std::string::npos);
    const std::string list = text.substr(begin, text.find("\n\n", begin) - begin);
    const TemporaryFolder folder;
    write_text(folder.file("changes.json"), list);
    const Outcome run = hertzline({"run", scene[1], "--changes", folder.file("changes.json"), "--columns",
                                   "v_out", "-o", folder.file("changed.csv")});
    ASSERT_EQ(run.status, 0) << run.err;
    ASSERT_EQ(hertzline({"run", scene[1], "--columns", "v_out", "-o", folder.file("plain.csv")}).status, 0);
    const auto changed = csv_of(folder.file("changed.csv")).at("v_out_m_per_s");
    const auto plain = csv_of(folder.file("plain.csv")).at("v_out_m_per_s");
    ASSERT_EQ(changed.size(), plain.size());
    for (const Json& change : Json::parse(list)) {
        const auto sample = change["sample"].get<std::size_t>();
        ASSERT_LT(sample + 1000, plain.size());
        EXPECT_FALSE(std::equal(plain.begin() + static_cast<std::ptrdiff_t>(sample),
                                plain.begin() + static_cast<std::ptrdiff_t>(sample) + 1000,
                                changed.begin() + static_cast<std::ptrdiff_t>(sample)))
            << sample;
    }
}

TEST(ChangedRun, TheErrorOfAChangedRunIsThatOfItsWorstScene) {
    const TemporaryFolder folder;
    write_text(folder.file("changes.json"), R"([{"sample": 3000, "set": {"drive.amplitude_m": 8e-6}}])");
    // a quiet wall, then so loud that contacts open and the motion amplifies rounding errors
    const Words words{"run",   "paper-wall",
                      "--set", "chain.damping_kg_per_s=0.05",
                      "--set", "chain.preload_n=0.05",
                      "--set", "drive.amplitude_m=1e-9",
                      "--set", "output.sample_rate_hz=1e6",
                      "--set", "output.duration_s=8e-3",
                      "--json"};
    const Json quiet = hertzline(words).json();
    const Outcome changed = hertzline(with(words, {"--changes", folder.file("changes.json")}));
    ASSERT_EQ(changed.status, 0) << changed.err;
    const Json summary = changed.json();
    Words loud = words;
    loud[7] = "drive.amplitude_m=8e-6";
    loud[11] = "output.duration_s=5e-3";
    const Json alone = hertzline(loud).json();
    ASSERT_GT(alone["estimated_error"], 1e-4);
    EXPECT_LT(quiet["estimated_error"], 1e-4);
    EXPECT_GE(summary["estimated_error"], 0.1 * alone["estimated_error"].get<double>());
    EXPECT_THAT(changed.err, HasSubstr("change from sample 3000 on: the estimated error"));
    EXPECT_THAT(summary["warnings"].dump(), HasSubstr("change from sample 3000 on: the estimated error"));
}

TEST(ChangedRun, TheSummaryOfAChangedRunIsOfAllOfIt) {
    const TemporaryFolder folder;
    const Words words{"run", "paper-stream", "--set", "output.sample_rate_hz=1e6", "--json"};
    const auto summary = [&](const Words& more) { return hertzline(with(words, more)).json(); };
    const Json loud = summary({"--set", "output.duration_s=1e-3"});
    // the motion continues or restarts; the loud part is over by then
    for (const char* change :
         {R"("drive.amplitude_m": 1e-11)", R"("drive.amplitude_m": 0, "chain.preload_n": 0.2)"}) {
        write_text(folder.file("changes.json"),
                   fmt::format(R"([{{"sample": 1000, "set": {{{}}}}}])", change));
        const Json all =
            summary({"--set", "output.duration_s=2e-3", "--changes", folder.file("changes.json")});
        EXPECT_EQ(all["peak_contact_force_n"], loud["peak_contact_force_n"]) << change;
        EXPECT_EQ(all["peak_strength_ratio"], loud["peak_strength_ratio"]) << change;
        EXPECT_EQ(all["contact_events"], loud["contact_events"]) << change;
        EXPECT_GT(all["steps"], loud["steps"]) << change;
    }
}

TEST(ChangedRun, AHornThatIsSwitchedOffLetsTheChainRingDown) {
    const TemporaryFolder folder;
    for (const char* amplitude : {"0", "1e-300"}) {
        write_text(folder.file("changes.json"),
                   fmt::format(R"([{{"sample": 1000, "set": {{"drive.amplitude_m": {}}}}}])", amplitude));
        const std::string file = folder.file("off.csv");
        // the burst restarts at the change, so the first one is cut off while the chain moves
        const Outcome run = hertzline({"run", "paper-stream", "--set", "drive.repetition_hz=2500", "--set",
                                       "output.sample_rate_hz=2.5e6", "--set", "output.duration_s=2e-3",
                                       "--changes", folder.file("changes.json"), "-o", file});
        ASSERT_EQ(run.status, 0) << run.err;
        const auto v_out = csv_of(file).at("v_out_m_per_s");
        EXPECT_GT(std::abs(v_out[1010]), 1e-6) << amplitude;
        EXPECT_LT(std::abs(v_out[5000]), 1e-6) << amplitude;
    }
}

TEST(ChangedRun, AChangedPlateInWaterIsTheSameAgain) {
    const TemporaryFolder folder;
    write_text(
        folder.file("changes.json"),
        R"([{"sample": 100, "set": {"drive.amplitude_m": 1e-6}}, {"sample": 150, "set": {"output.points_m[2]": [1e-3, 0, 3e-3]}},
            {"sample": 180, "set": {"medium.load": "none"}},
            {"sample": 220, "set": {"end.materials": ["acrylic", "aluminium"], "end.thicknesses_m": [1e-4, 3e-4]}},
            {"sample": 250, "set": {"end.theory": "thin", "output.points_m[1][3]": 4e-3}}])");
    const std::string first = folder.file("first.h5");
    const std::string columns = "v_out,p_axis,p_points";
    const Outcome run =
        hertzline({"run", "wet-vitreous-carbon", "--set", "output.duration_s=3e-4", "--set",
                   "output.sample_rate_hz=1e6", "--set", "output.points_m=[[0, 0, 5e-3], [2e-3, 1e-3, 5e-3]]",
                   "--changes", folder.file("changes.json"), "--columns", columns, "-o", first});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(changes_in_file(first).size(), 5U);
    EXPECT_TRUE(numbers_in(first) == simulated_again(first, folder.file("again.h5"), columns));
}

TEST(ChangedRun, AChangedChainAndHornAreTheSameAgain) {
    const TemporaryFolder folder;
    write_text(
        folder.file("changes.json"),
        R"([{"sample": 100, "set": {"chain.diameters_m": [1e-3, 0.8e-3], "chain.materials": ["aluminium", "steel"]}},
            {"sample": 200, "set": {"chain.diameters_m[2]": 0.9e-3, "chain.taper": 0.02}},
            {"sample": 300, "set": {"chain.gravity_m_per_s2": 9.8, "chain.holder_time_s": 1e-3}},
            {"sample": 400, "set": {"drive.horn": "resonator", "drive.horn_quality": 30, "drive.horn_mass_kg": 1e-3}},
            {"sample": 500, "set": {"drive.sweep_to_hz": 90e3, "drive.start_s": 20e-6}},
            {"sample": 600, "set": {"drive.kind": "none", "chain.impact_velocity_m_per_s": 0.5, "chain.impact_spheres": 2}}])");
    const std::string first = folder.file("first.h5");
    const std::string columns = "v_out,v_horn,f_first";
    const Outcome run = hertzline({"run", "paper-wall", "--set", "output.duration_s=7.5e-4", "--set",
                                   "output.sample_rate_hz=1e6", "--changes", folder.file("changes.json"),
                                   "--columns", columns, "-o", first});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(changes_in_file(first).size(), 6U);
    EXPECT_TRUE(numbers_in(first) == simulated_again(first, folder.file("again.h5"), columns));
}

}  // namespace

}  // namespace hertzline::test
