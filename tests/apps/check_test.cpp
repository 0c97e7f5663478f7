// hertzline check: derived values, the integrator and its step, and the reasons for them.

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "measures/resources.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST(Check, DerivesThePapersNumbers) {
    const Outcome outcome = hertzline({"check", "paper-vitreous-carbon", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto derived = outcome.json();
    const auto value = [&derived](const char* name) { return derived.at(name).get<double>(); };
    EXPECT_NEAR(value("sphere_mass_kg"), 1.4137e-6, 1e-10);
    EXPECT_NEAR(value("plate_stiffness_n_per_m"), 7.50e5, 1e3);
    EXPECT_NEAR(value("plate_frequency_hz"), 36.9e3, 0.1e3);
    EXPECT_NEAR(value("transmission"), 0.6902, 1e-4);
    EXPECT_NEAR(value("plate_moving_mass_kg"), value("plate_mass_kg") / 4, 1e-18);
    EXPECT_NEAR(value("burst_duration_s"), 25 / 73e3, 1e-15);
    EXPECT_EQ(value("rows"), 5001);
    EXPECT_LT(value("step_s"), value("largest_stable_step_s"));
    EXPECT_GT(value("fastest_dynamic_hz"), value("fastest_static_hz"));
    EXPECT_NEAR(value("steps_per_sample"), 1 / (10e6 * value("step_s")), 1e-9);
    EXPECT_EQ(derived["accuracy_met"], true);
    EXPECT_EQ(derived["integrator"], "taylor8");
}

TEST(Check, ThePressuresOfTheFirstBurstDoNotDependOnTheSampleRate) {
    const auto checked = [](const std::string& rate) {
        return hertzline({"check", "sonic-vacuum", "--set", "output.sample_rate_hz=" + rate, "--json"})
            .json();
    };
    const auto fine = checked("10e6");
    const auto coarse = checked("1e3");
    for (const char* name : {"sphere_contact_peak_pressure_pa", "fastest_dynamic_hz"}) {
        EXPECT_NEAR(coarse.at(name).get<double>() / fine.at(name).get<double>(), 1, 0.01) << name;
    }
}

TEST(Check, RestsOnTheEndWhereSpheresHaveWeightAndHasNoBurstWithoutAHorn) {
    const auto heavy =
        hertzline({"check", "paper-wall", "--json", "--set", "chain.gravity_m_per_s2=5000"}).json();
    // p = 3 k sqrt(delta) / (pi R) with k delta^1.5 = F0 + 5 m g
    const double force = 0.1 + 5 * heavy["sphere_mass_kg"].get<double>() * 5000;
    const double k = heavy["sphere_contact_stiffness_n_per_m1_5"].get<double>();
    const double most = 3 * k * std::cbrt(force / k) / (std::numbers::pi * 0.5e-3);
    EXPECT_NEAR(heavy["sphere_contact_static_pressure_pa"].get<double>(), most, 1e-3 * most);
    EXPECT_TRUE(hertzline({"check", "striker", "--json"}).json()["burst_duration_s"].is_null());
}

TEST(Check, ReportsItsChoicesWithReasons) {
    struct Case {
        const char* setting;
        const char* integrator;
        const char* reason;
        const char* role;
        const char* chosen_by;
        double wanted;
    };
    for (const Case& c :
         {Case{"chain.spheres=6", "taylor8", "fastest at this accuracy", "longest piece", "accuracy", 1e-4},
          Case{"numerics.accuracy=1e-7", "taylor12", "accuracy below 1e-06", "longest piece", "accuracy",
               1e-7},
          Case{"chain.spheres=501", "taylor8", "fastest at this accuracy", "longest piece", "accuracy", 1e-4},
          Case{"numerics.integrator=chin4a", "chin4a", "set by the scene", "step", "accuracy", 1e-4},
          Case{"numerics.step_s=400e-9", "taylor8", "fastest at this accuracy", "longest piece", "scene",
               1e-4}}) {
        const auto derived = hertzline({"check", "paper-wall", "--json", "--set", c.setting}).json();
        EXPECT_EQ(derived["integrator"], c.integrator);
        EXPECT_THAT(derived["integrator_reason"].get<std::string>(), StartsWith(c.reason));
        EXPECT_EQ(derived["step_role"], c.role);
        EXPECT_EQ(derived["step_chosen_by"], c.chosen_by);
        EXPECT_EQ(derived["wanted_accuracy"], c.wanted);
        EXPECT_LE(derived["estimated_error"].get<double>(), c.wanted) << c.setting;
        EXPECT_GE(derived["pilots"].get<double>(), 3) << c.setting;  // the reference is two
        EXPECT_GE(derived["pilot_duration_s"].get<double>(), 25 / 73e3) << c.setting;
        EXPECT_GE(derived["estimated_over_s"].get<double>(), 25 / 73e3) << c.setting;
        const double grid = 25 / 73e3 / derived["step_s"].get<double>();
        const double expected = derived["steps_per_burst"].get<double>();
        EXPECT_GE(expected, 0.999 * grid) << c.setting;
        EXPECT_LE(expected, (c.role == std::string("step") ? 1.001 : 4) * grid) << c.setting;
    }
}

TEST(Check, ReportsTheMemoryOfEachRecordingOfAStream) {
    const auto bytes = [](const char* rate) {
        return hertzline({"check", "paper-stream", "--json", "--set", rate})
            .json()["stream_recording_memory_bytes"]
            .get<double>();
    };
    EXPECT_EQ(bytes("output.sample_rate_hz=10e6"), 256.0 * 1024 * 1024);
    EXPECT_EQ(bytes("output.sample_rate_hz=1e6"),
              2.0 * 1e6 * 3 * sizeof(double));  // two seconds of three columns
}

TEST(Check, CountsTheQueuesOfSubscribersAmongTheMemoryOfAStream) {
    const auto stream =
        hertzline({"check", "paper-wall", "--json"}).json()["stream_memory_bytes"].get<double>();
    EXPECT_GT(stream,
              std::min(1024.0 * 1024 * 1024, static_cast<double>(*measures::available_memory_bytes()) / 10));
    const Outcome outcome = hertzline({"stream", "paper-wall", "--queue-memory", "1000TiB"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, testing::HasSubstr("memory"));
}

TEST(Check, KnowsNoErrorOfAStepTooShortForAPilot) {
    const auto derived =
        hertzline({"check", "paper-wall", "--json", "--set", "numerics.step_s=1e-12"}).json();
    EXPECT_TRUE(derived["estimated_error"].is_null());
    EXPECT_LE(derived["recommended_step_estimated_error"].get<double>(), 1e-4);
}

TEST(Check, HasNoPlateWhereThereIsNone) {
    const auto derived = hertzline({"check", "paper-wall", "--json"}).json();
    for (const char* name :
         {"plate_mass_kg", "plate_stiffness_n_per_m", "plate_frequency_hz", "transmission"}) {
        EXPECT_TRUE(derived.at(name).is_null()) << name;
    }
    EXPECT_TRUE(hertzline({"check", "paper-wall", "--set", "end.kind=free", "--json"})
                    .json()
                    .at("end_contact_stiffness_n_per_m1_5")
                    .is_null());
    EXPECT_TRUE(hertzline({"check", "paper-wall", "--set", "chain.spheres=1", "--json"})
                    .json()
                    .at("wave_speed_m_per_s")
                    .is_null());
}

TEST(Check, NamesTheLawOfDampingWhereItIsNotTheDashpot) {
    const std::vector<std::string> tsuji{
        "check", "paper-wall", "--set", "chain.damping_law=tsuji", "--set", "chain.damping_alpha=0.2"};
    EXPECT_THAT(hertzline(tsuji).out, ContainsRegex("law of damping +tsuji"));
    EXPECT_FALSE(hertzline({"check", "paper-wall", "--json"}).json().contains("damping_law"));
    std::vector<std::string> run = tsuji;
    run[0] = "run";
    run.emplace_back("--json");
    EXPECT_EQ(hertzline(run).json().at("damping_law"), "tsuji");
    EXPECT_FALSE(hertzline({"run", "paper-wall", "--json"}).json().contains("damping_law"));
}

// Frequencies, section and loss: an independent program (tests/core/plate/laminate_test.cpp).
TEST(Check, TellsTheModesAndTheSectionOfALaminate) {
    const auto check = hertzline({"check", "wet-layers", "--json"}).json();
    const std::vector<double> dry_khz{27.6, 92.4, 176.2, 269.0};
    for (std::size_t n = 0; n < dry_khz.size(); ++n) {
        const std::string mode = "mode_" + std::to_string(n + 1);
        EXPECT_NEAR(check[mode + "_dry_hz"].get<double>() / 1e3, dry_khz[n], 0.06);
        EXPECT_LT(check[mode + "_wet_hz"], check[mode + "_dry_hz"]);
        EXPECT_GT(check[mode + "_wet_hz"].get<double>(), 0.4e3 * dry_khz[n]);
    }
    EXPECT_NEAR(check["laminate_bending_n_m"].get<double>(), 0.241100948434, 1e-11);
    EXPECT_NEAR(check["laminate_mass_kg_per_m2"].get<double>(), 1.135, 1e-11);
    EXPECT_NEAR(check["laminate_loss_factor"].get<double>(), 0.0148711564, 1e-9);
    EXPECT_NEAR(check["laminate_neutral_plane_m"].get<double>(), 0.129482356e-3, 1e-12);
    EXPECT_NEAR(check["travel_s"].get<double>(), 10e-3 / 1482, 1e-9);
    EXPECT_LE(check["fit_velocity_error"], 1e-4);
}

TEST(Check, TellsTheSpheresOfAMixedChain) {
    const auto check = hertzline({"check", "dimer-chain", "--json"}).json();
    EXPECT_LT(check["lightest_sphere_kg"], check["heaviest_sphere_kg"]);
    const auto ball = [](double density) { return density * std::numbers::pi / 6 * 1e-9; };
    EXPECT_NEAR(check["lightest_sphere_kg"].get<double>(), ball(2700), 1e-9);
    EXPECT_NEAR(check["heaviest_sphere_kg"].get<double>(), ball(7833), 2e-9);
}

TEST(Check, TextHasUnitsAndNoMessages) {
    const Outcome outcome = hertzline(
        {"check", "paper-acrylic", "--set", "chain.preload_n=0.01", "--set", "drive.amplitude_m=1e-8"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, HasSubstr("1.41372e-06 kg"));
    EXPECT_THAT(outcome.out, HasSubstr("N/m^1.5"));
    EXPECT_THAT(outcome.err, IsEmpty());
}

TEST(Check, EveryShippedSceneIsGood) {
    for (const ShippedScene& scene : shipped_scenes()) {
        const Outcome outcome = hertzline({"check", std::string(scene.name)});
        EXPECT_EQ(outcome.status, 0) << scene.name << ": " << outcome.err;
    }
}

}  // namespace

}  // namespace hertzline::test
