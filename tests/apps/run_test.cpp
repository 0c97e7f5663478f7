// hertzline run, as its users see it.

#include <csignal>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/apps/program.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Key;
using testing::Not;

const std::vector<std::string> contract_names{"simulated_s",
                                              "wall_s",
                                              "real_time_factor",
                                              "steps",
                                              "step_s",
                                              "setup_s",
                                              "estimated_over_s",
                                              "integrator",
                                              "estimated_error",
                                              "contact_events",
                                              "energy_residual",
                                              "peak_v_last_m_per_s",
                                              "peak_v_out_m_per_s",
                                              "fundamental_hz",
                                              "harmonics_db",
                                              "thd_r",
                                              "bandwidth_6db_hz",
                                              "bandwidth_20db_hz",
                                              "scene_hash",
                                              "version"};

TEST(Run, SummaryHasTheContractsNamesInJsonAndText) {
    const Outcome printed = hertzline({"run", "paper-vitreous-carbon", "--json"});
    ASSERT_EQ(printed.status, 0) << printed.err;
    const Outcome text = hertzline({"run", "paper-vitreous-carbon"});
    ASSERT_EQ(text.status, 0) << text.err;
    for (const std::string& name : contract_names) {
        EXPECT_TRUE(printed.json().contains(name)) << name;
        EXPECT_THAT(text.out, HasSubstr(name));
    }
}

TEST(Run, ReproducesThePapersDevice) {
    const auto summary = hertzline({"run", "paper-vitreous-carbon", "--json"}).json();
    EXPECT_EQ(summary["simulated_s"], 500e-6);
    EXPECT_NEAR(summary["peak_v_out_m_per_s"].get<double>(), 0.355, 0.002);
    EXPECT_EQ(summary["fundamental_hz"], 73e3);
    const std::vector<double> levels{-5.7, 0, -4.0, -13.0, -24.4};
    for (std::size_t k = 0; k < levels.size(); ++k) {
        EXPECT_NEAR(summary["harmonics_db"][k].get<double>(), levels[k], 0.3) << "harmonic " << k + 1;
    }
    EXPECT_GT(summary["bandwidth_20db_hz"].get<double>(), summary["bandwidth_6db_hz"].get<double>());
    EXPECT_LT(summary["energy_residual"].get<double>(), 1e-3);
}

TEST(Run, EstimatesTheErrorOfAnyStepThatAPilotCanAfford) {
    const auto estimate = [](const Words& settings) {
        Words words{"run", "paper-vitreous-carbon", "--json"};
        for (const std::string& setting : settings) {
            words.insert(words.end(), {"--set", "numerics." + setting});
        }
        return hertzline(words).json()["estimated_error"];
    };
    EXPECT_LE(estimate({}).get<double>(), 1e-4);
    EXPECT_LE(estimate({"accuracy=1e-8"}).get<double>(), 1e-8);
    // 3.4e-5 is the error of v_out with this step, against the reference of tests/reference
    const double given = estimate({"integrator=chin4a", "step_s=200e-9"}).get<double>();
    EXPECT_GT(given, 3.4e-5 / 3);
    EXPECT_LT(
        given,
        3.4e-5 * 5);  // a sample beside a jump of v_out is expected on the wrong side, and was not there
    const auto brief = hertzline({"run", "paper-vitreous-carbon", "--json", "--set", "numerics.step_s=1e-12",
                                  "--set", "output.duration_s=1e-7"})
                           .json();
    EXPECT_TRUE(brief["estimated_error"].is_null());
    EXPECT_TRUE(brief["estimated_over_s"].is_null());
}

TEST(Run, NothingGoesToStderrWithoutATerminal) {
    const Words gentle{
        "run", "paper-wall", "--set", "chain.preload_n=0.01", "--set", "drive.amplitude_m=1e-8"};
    EXPECT_THAT(hertzline(gentle).err, IsEmpty());  // no contact yields
}

TEST(Run, FilesHoldEverySampleUpToAndIncludingTheDuration) {
    const TemporaryFolder folder;
    const Outcome outcome = hertzline(
        {"run", "paper-vitreous-carbon", "-o", folder.file("a.csv"), "-o", folder.file("b.csv"), "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto columns = csv_of(folder.file("a.csv"));
    EXPECT_THAT(columns,
                ElementsAre(Key("t_s"), Key("v_last_m_per_s"), Key("v_out_m_per_s"), Key("v_plate_m_per_s")));
    const std::vector<double>& time = columns.at("t_s");
    ASSERT_EQ(time.size(), 5001U);
    EXPECT_EQ(time.front(), 0);
    EXPECT_EQ(time.back(), 500e-6);
    EXPECT_EQ(outcome.json()["rows"], 5001);
    EXPECT_EQ(contents(folder.file("a.csv")), contents(folder.file("b.csv")));
    EXPECT_EQ(files_in(std::filesystem::path(folder.file("a.csv")).parent_path()), 4U);  // and their metadata
}

TEST(Run, TapsAreSavedOnRequestBesideTheUsualColumns) {
    const TemporaryFolder folder;
    const Outcome outcome =
        hertzline({"run", "paper-wall", "-o", folder.file("a.csv"), "--tap", "v_out", "--tap", "x_chain",
                   "--set", "chain.spheres=2", "--set", "output.duration_s=1e-6"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(csv_of(folder.file("a.csv")), ElementsAre(Key("t_s"), Key("v_last_m_per_s"),
                                                          Key("v_out_m_per_s"), Key("x1_m"), Key("x2_m")));
}

TEST(Run, ATapWithoutAFileIsRefused) {
    const Outcome outcome = hertzline({"run", "paper-wall", "--tap", "v_horn"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--tap"));
}

TEST(Run, ATapThatTheSceneLacksIsRefused) {
    for (const char* name : {"v_plate", "v_outt"}) {
        const TemporaryFolder folder;
        const Outcome outcome = hertzline({"run", "paper-wall", "-o", folder.file("a.csv"), "--tap", name});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.err,
                    AllOf(HasSubstr("--tap: found \"" + std::string(name) + "\""), HasSubstr("v_chain")));
    }
}

TEST(Run, RowsStopBeforeADurationBetweenSamples) {
    const auto summary =
        hertzline({"run", "paper-wall", "--json", "--set", "output.duration_s=10.19e-6"}).json();
    EXPECT_EQ(summary["rows"], 102);
    EXPECT_NEAR(summary["simulated_s"].get<double>(), 10.1e-6, 1e-18);
}

TEST(Run, RoundingOfTheDurationLosesNoRow) {
    // 2.1e-6 * 10e6 is 20.999999999999996
    const auto summary =
        hertzline({"run", "paper-wall", "--json", "--set", "output.duration_s=2.1e-6"}).json();
    EXPECT_EQ(summary["rows"], 22);
}

TEST(Run, AllAddsEverySphere) {
    const TemporaryFolder folder;
    const Outcome outcome = hertzline({"run", "paper-wall", "--all", "-o", folder.file("all.csv"), "--set",
                                       "chain.spheres=2", "--set", "output.duration_s=100e-6"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto columns = csv_of(folder.file("all.csv"));
    EXPECT_THAT(columns, ElementsAre(Key("t_s"), Key("v1_m_per_s"), Key("v2_m_per_s"), Key("v_last_m_per_s"),
                                     Key("x1_m"), Key("x2_m")));
    EXPECT_EQ(columns.at("v2_m_per_s"), columns.at("v_last_m_per_s"));
}

TEST(Run, ASilentRunHasNoSpectrum) {
    const auto summary = hertzline({"run", "paper-wall", "--json", "--set", "drive.amplitude_m=0"}).json();
    EXPECT_EQ(summary["peak_v_out_m_per_s"], 0);
    for (const char* name : {"harmonics_db", "thd_r", "bandwidth_6db_hz", "bandwidth_20db_hz"}) {
        EXPECT_TRUE(summary[name].is_null()) << name;
    }
}

TEST(Run, BandsAndDistortionAreThoseThatAnIndependentAnalysisFinds) {
    // An FFT of the same waveform elsewhere: lines above -20 dB at 67.5 to 295.7 kHz, about 40 kHz in all with 3.4 kHz at 0 Hz.
    const auto summary = hertzline({"run", "paper-vitreous-carbon", "--json"}).json();
    EXPECT_NEAR(summary["band_20db_low_hz"].get<double>(), 67.5e3, 300);
    EXPECT_NEAR(summary["band_20db_high_hz"].get<double>(), 295.7e3, 300);
    EXPECT_NEAR(summary["bandwidth_20db_hz"].get<double>(), 228.2e3, 500);
    EXPECT_NEAR(summary["occupied_20db_hz"].get<double>(), 37e3, 2e3);
    EXPECT_EQ(summary["band_from_hz"], 36.5e3);
    EXPECT_NEAR(summary["dc_db"].get<double>(), -17.5, 0.3);
    EXPECT_NEAR(summary["strongest_hz"].get<double>(), 146e3, 2e3);
    const auto from_zero = hertzline({"run", "paper-vitreous-carbon", "--band-from", "0", "--json"}).json();
    EXPECT_EQ(from_zero["band_20db_low_hz"], 0);
}

TEST(Run, SaysWhatTheSwitchingOfTheLastContactAddsToEachHarmonic) {
    const Outcome outcome = hertzline({"run", "paper-vitreous-carbon", "--json"});
    // The sixth and ninth harmonics lie at -34.5 and -38.4 dB with the jumps, at -41.6 and -54.3 without.
    const auto summary = outcome.json();
    // Both are levels under the second, which the jumps change, too.
    const auto of_harmonic = [&](std::size_t k) { return summary["switching_db"][k - 1].get<double>(); };
    EXPECT_NEAR(of_harmonic(6) - of_harmonic(2), 41.6 - 34.5, 0.1);
    EXPECT_NEAR(of_harmonic(9) - of_harmonic(2), 54.3 - 38.4, 0.1);
    EXPECT_THAT(outcome.err, ContainsRegex("warning: harmonics 6, .*jumps"));
    EXPECT_TRUE(hertzline({"run", "paper-wall", "--json"}).json()["switching_db"].is_null());
}

TEST(Run, MeasuresOtherOutputsOnRequest) {
    const Outcome outcome =
        hertzline({"run", "paper-vitreous-carbon", "--measure", "v_plate,f_last", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto summary = outcome.json();
    EXPECT_GT(summary["f_last"]["peak_f_last_n"].get<double>(), 0.1);  // the preload
    EXPECT_EQ(summary["v_plate"]["harmonics_db"].size(), 10U);
    const auto same = hertzline({"run", "paper-wall", "--measure", "v_last", "--json"}).json();
    EXPECT_EQ(same["v_last"]["harmonics_db"], same["harmonics_db"]);  // without a plate v_out is v_last
    EXPECT_EQ(same["v_last"]["peak_v_last_m_per_s"], same["peak_v_last_m_per_s"]);
    const Outcome text = hertzline({"run", "paper-vitreous-carbon", "--measure", "v_plate"});
    EXPECT_THAT(text.out, ContainsRegex("\nv_plate\n  peak_v_plate_m_per_s +[0-9]"));
}

TEST(Run, RefusesToMeasureWhatIsNotThereOrHasNoSpectrumOfItsOwn) {
    for (const char* name : {"v_plate", "v_chain", "v_outt"}) {
        const Outcome outcome = hertzline({"run", "paper-wall", "--measure", name});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.err,
                    AllOf(HasSubstr("--measure: found \"" + std::string(name) + "\""), HasSubstr("f_last")));
    }
    for (const char* frequency : {"-1", "nan", "inf"}) {
        const Outcome outcome = hertzline({"run", "paper-wall", "--band-from", frequency});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.err, HasSubstr("--band-from"));
    }
}

TEST(Run, ThePeakForceDoesNotDependOnTheLengthOfPieces) {
    for (const char* scene : {"paper-wall", "wet-vitreous-carbon", "paper-acrylic"}) {
        const auto peak = [&](const std::string& accuracy) {
            return hertzline({"run", scene, "--json", "--set", "numerics.accuracy=" + accuracy})
                .json()["peak_contact_force_n"]
                .get<double>();
        };
        EXPECT_NEAR(peak("1e-3") / peak("1e-6"), 1, 4e-3) << scene;  // 4 % less at the ends of pieces
    }
}

TEST(Run, TellsWhatTheContactsCarry) {
    const auto summary = hertzline({"run", "paper-vitreous-carbon", "--json"}).json();
    // Independent arithmetic on the recorded displacements: 2.6 N and 2.3 GPa between spheres.
    EXPECT_NEAR(summary["peak_contact_force_n"].get<double>(), 2.6, 0.1);
    EXPECT_NEAR(summary["peak_contact_pressure_pa"].get<double>(), 2.3e9, 0.1e9);
    EXPECT_LT(summary["peak_overlap_ratio"].get<double>(), 0.05);
    EXPECT_NEAR(summary["static_contact_pressure_pa"].get<double>(), 0.77e9, 0.01e9);
    EXPECT_NEAR(summary["peak_strength_ratio"].get<double>(),
                summary["peak_contact_pressure_pa"].get<double>() / (1.6 * 276e6), 1e-9);
    const Outcome deep = hertzline({"run", "paper-wall", "--set", "drive.amplitude_m=5e-5"});
    EXPECT_THAT(deep.err, HasSubstr("deep by the motion; Hertz's law is for less than 0.05"));
}

TEST(Run, SameSceneSameHashOtherSceneOtherHash) {
    const auto hash = [](const std::string& setting) {
        return hertzline({"run", "paper-wall", "--json", "--set", setting}).json()["scene_hash"];
    };
    EXPECT_EQ(hash("chain.spheres=6"), hash("drive.cycles=25"));
    EXPECT_NE(hash("chain.spheres=6"), hash("chain.spheres=5"));
}

TEST(Run, AgainHasTheEstimateOfTheFirstTime) {
    const TemporaryFolder folder;
    const std::string file = folder.file("r.h5");
    const auto estimate = [](const Words& words) {
        const Outcome outcome = hertzline(with({"run", "--json"}, words));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const auto summary = outcome.json();
        return std::tuple(summary["estimated_error"], summary["estimated_over_s"], summary["warnings"]);
    };
    const auto expect_the_same = [&](const Words& settings) {
        const auto first = estimate(with({"paper-wall", "-o", file}, settings));
        EXPECT_EQ(estimate({file}), first) << testing::PrintToString(settings);
    };
    expect_the_same({"--set", "output.duration_s=5e-5", "--set", "numerics.accuracy=1e-3"});
    expect_the_same({"--set", "output.duration_s=3e-3", "--set", "output.sample_rate_hz=2e6"});
    expect_the_same({"--set", "output.duration_s=1e-4", "--set", "numerics.step_s=3e-7"});
    expect_the_same({"--set", "output.duration_s=1e-4", "--set", "numerics.accuracy=1e-14"});
}

TEST(Run, PutsNothingInThePlaceOfItsChanges) {
    const TemporaryFolder folder;
    const std::string file = folder.file("changes.csv");
    const std::string text = R"([{"sample": 200, "set": {"drive.amplitude_m": 2e-6}}])";
    write_text(file, text);
    const Outcome outcome = hertzline({"run", "paper-wall", "--changes", file, "-o", file});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("found a file that is read here"));
    EXPECT_EQ(contents(file), text);
}

TEST(Run, InterruptedRunLeavesNoFile) {
    const TemporaryFolder folder;
    Program program({"run", "paper-stream", "-o", folder.file("long.csv"), "--set", "output.duration_s=1.2"});
    const std::filesystem::path directory = std::filesystem::path(folder.file("long.csv")).parent_path();
    ASSERT_TRUE(eventually([&] { return files_in(directory) > 0; })) << "it has not begun to write";
    program.send(SIGINT);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("stopped"));
    EXPECT_EQ(files_in(directory), 0U);
}

TEST(Run, SceneMayBeAFileOfAnyName) {
    const TemporaryFolder folder;
    const std::string file = folder.file("m\u00fcller \u6ce2.toml");
    write_text(file, "[end]\nkind = \"wall\"\nmaterial = \"steel\"\n");
    const auto mine = hertzline({"run", file, "--json"}).json();
    EXPECT_EQ(mine["scene_hash"], hertzline({"run", "paper-wall", "--json"}).json()["scene_hash"]);
    write_text(file, "[end]\nkind = \"\u6ce2\"\n");
    EXPECT_THAT(hertzline({"run", file}).err,
                HasSubstr("m\u00fcller \u6ce2.toml:2: end.kind: found \"\u6ce2\", allowed: "));
}

}  // namespace

}  // namespace hertzline::test
