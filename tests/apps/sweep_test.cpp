// hertzline sweep: its rows, and refused requests.

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/quick_points.hpp"
#include "tests/support/files.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

/// Returns the rows that --json prints.
std::vector<json> rows_of(const Outcome& outcome) {
    std::vector<json> rows;
    std::istringstream lines(outcome.out);
    for (std::string line; std::getline(lines, line);) {
        rows.push_back(json::parse(line));
    }
    return rows;
}

/// Returns the numbers of a summary under a sweep's names.
void flatten(const json& summary, const std::string& before, json& flat) {
    for (const auto& [name, value] : summary.items()) {
        if (value.is_object()) {
            flatten(value, before + name + '.', flat);
        } else if (value.is_array() && before + name != "recordings") {
            for (std::size_t i = 0; i < value.size(); ++i) {
                flat[fmt::format("{}{}_{}", before, name, i + 1)] = value[i];
            }
        } else {
            flat[before + name] = value;
        }
    }
}

/// Returns whether a number differs from run to run, or stands elsewhere.
bool is_of_the_run_alone(const std::string& name) {
    static const Words names{"setup_s", "wall_s", "real_time_factor", "recordings", "version"};
    return std::ranges::find(names, name) != names.end() || name.starts_with("warnings");
}

/// Returns whether a number is an estimate: a sweep and a run estimate the same error by different ways.
bool is_an_estimate(const std::string& name) {
    return name == "estimated_error" || name == "estimated_over_s";
}

/// Expects that a row equals a run with the row's step.
void expect_row_of_run(const json& row, const Words& run) {
    const std::string step = fmt::format("numerics.step_s={}", row["step_s"].get<double>());
    const Outcome outcome = hertzline(with({"run"}, with(run, {"--set", step, "--json"})));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    json flat;
    flatten(outcome.json(), "", flat);
    for (const auto& [name, value] : flat.items()) {
        if (is_of_the_run_alone(name)) {
            continue;
        }
        // a missing array is null in a summary, and so are its columns
        const std::string column = row.contains(name) ? name : name + "_1";
        ASSERT_TRUE(row.contains(column)) << name;
        if (is_an_estimate(name)) {
            EXPECT_NEAR(row[column].get<double>(), value.get<double>(), 0.2 * value.get<double>()) << name;
        } else {
            EXPECT_EQ(row[column], value) << name;
        }
    }
}

TEST(Sweep, ATableIsAListOfPoints) {
    const TemporaryFolder folder;
    const std::string table = folder.file("a.csv");
    const std::string again = folder.file("b.csv");
    const Words keys{"--vary", "chain.preload_n=0.1,0.2", "--vary", "end.kind=free,wall"};
    const Outcome first = hertzline(with(quick_sweep, with(keys, {"-o", table, "--json"})));
    ASSERT_EQ(first.status, 0) << first.err;
    const Outcome second = hertzline(with(quick_sweep, {"--points", table, "-o", again, "--json"}));
    ASSERT_EQ(second.status, 0) << second.err;
    EXPECT_THAT(rows_of(second), SizeIs(4));
    EXPECT_EQ(contents(again), contents(table));
}

TEST(Sweep, ARowHasAllThatRunSays) {
    const Outcome outcome =
        hertzline({"sweep", "paper-vitreous-carbon", "--vary", "chain.preload_n=0.05..0.2:log:2", "--vary",
                   "end.kind=plate,wall", "--measure", "f_last", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::vector<json> rows = rows_of(outcome);
    ASSERT_THAT(rows, SizeIs(4));
    EXPECT_EQ(rows[0]["point"], 0);
    EXPECT_EQ(rows[0]["status"], "ok");
    for (std::size_t point = 0; point < rows.size(); ++point) {
        const std::string preload = point < 2 ? "0.05" : "0.2";
        const std::string end = point % 2 == 0 ? "plate" : "wall";
        EXPECT_EQ(rows[point]["chain.preload_n"], std::stod(preload));
        EXPECT_EQ(rows[point]["end.kind"], end);
        expect_row_of_run(rows[point], {"paper-vitreous-carbon", "--set", "chain.preload_n=" + preload,
                                        "--set", "end.kind=" + end, "--measure", "f_last"});
    }
}

TEST(Sweep, ARowOfAModalPlateHasAllThatRunSays) {
    const Words few{"wet-vitreous-carbon", "--set", "end.modes=1", "--set",
                    "numerics.poles=16"};  // fitted soon
    const Outcome outcome =
        hertzline(with({"sweep"}, with(few, {"--vary", "end.model=modal,lumped", "--json"})));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::vector<json> rows = rows_of(outcome);
    ASSERT_THAT(rows, SizeIs(2));
    expect_row_of_run(rows[0], few);
    expect_row_of_run(rows[1], with(few, {"--set", "end.model=lumped"}));
    EXPECT_TRUE(rows[1]["p_axis.thd_r"].is_null());
    EXPECT_FALSE(rows[0]["p_axis.thd_r"].is_null());
}

TEST(Sweep, PointsThatFailAreRowsWithTheirReason) {
    const Outcome outcome =
        hertzline({"sweep", "paper-wall", "--vary", "drive.repetition_hz=0,5000", "--vary",
                   "numerics.step_s=2e-8,1e-5", "--set", "numerics.integrator=leapfrog", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("2 of 4 points cannot be simulated; point 2 (drive.repetition_hz=5000"),
                      HasSubstr("3 of 4 points are not ok: 3 refused")));
    const std::vector<json> rows = rows_of(outcome);
    ASSERT_THAT(rows, SizeIs(4));
    EXPECT_EQ(rows[0]["status"], "ok");
    EXPECT_EQ(rows[0]["message"].get<std::string>().find("refused"), std::string::npos);
    EXPECT_EQ(rows[1]["status"], "refused");
    EXPECT_THAT(rows[1]["message"].get<std::string>(),
                HasSubstr("numerics.step_s: found 1e-05, allowed: at most"));
    EXPECT_TRUE(rows[1]["peak_v_out_m_per_s"].is_null());
    EXPECT_EQ(rows[3]["status"], "refused");
    EXPECT_THAT(rows[3]["message"].get<std::string>(), HasSubstr("drive.repetition_hz: found 5000, allowed"));
}

TEST(Sweep, UnstablePointsAreRows) {
    const TemporaryFolder folder;
    // The motion of the second point is chaotic. The moment of its failure depends on the instruction set, so it lasts long.
    write_text(folder.file("p.csv"), "drive.amplitude_m,output.duration_s\n1e-6,1e-3\n1.05e-3,0.5\n");
    const Outcome outcome = hertzline({"sweep", "paper-stream", "--points", folder.file("p.csv"), "--set",
                                       "output.sample_rate_hz=2e6", "--set", "numerics.integrator=leapfrog",
                                       "--set", "numerics.step_s=2.3e-7", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("1 unstable"));
    const std::vector<json> rows = rows_of(outcome);
    EXPECT_EQ(rows.at(0)["status"], "ok");
    EXPECT_EQ(rows.at(1)["status"], "unstable");
    EXPECT_THAT(rows.at(1)["message"].get<std::string>(), HasSubstr("stability limit"));
    EXPECT_TRUE(rows.at(1)["peak_v_out_m_per_s"].is_null());
}

TEST(Sweep, ChaoticAndInaccuratePointsHaveNumbersAndTheirReason) {
    const auto second_row = [](const std::string& scene, const std::string& vary,
                               const std::string& set = "numerics.rest_tolerance=0") {
        const Outcome outcome = hertzline({"sweep", scene, "--vary", vary, "--set", set, "--json"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const std::vector<json> rows = rows_of(outcome);
        EXPECT_EQ(rows.at(0)["status"], "ok");
        EXPECT_TRUE(rows.at(1)["peak_v_out_m_per_s"].is_number());
        return rows.at(1);
    };
    const json inaccurate = second_row("paper-wall", "numerics.accuracy=1e-4,1e-15");
    EXPECT_EQ(inaccurate["status"], "inaccurate");
    EXPECT_THAT(inaccurate["message"].get<std::string>(), HasSubstr("above the requested accuracy of 1e-15"));
    const json grown =
        second_row("paper-acrylic", "output.duration_s=8e-3,40e-3", "drive.repetition_hz=1400");
    EXPECT_EQ(grown["status"], "inaccurate");
    EXPECT_THAT(grown["message"].get<std::string>(), HasSubstr("errors grow"));
    const json chaotic = second_row("sonic-vacuum", "chain.damping_kg_per_s=0.32,0");
    EXPECT_EQ(chaotic["status"], "chaotic");
    EXPECT_THAT(chaotic["message"].get<std::string>(), HasSubstr("the motion amplifies rounding errors"));
}

TEST(Sweep, RunTakesTheStepsOfRows) {
    // a contact that closes with more damping than was expected lowers the stability limit
    const Words scene{"paper-wall", "--set",          "drive.cycles=1", "--set", "drive.frequency_hz=20000",
                      "--set",      "chain.spheres=1"};
    for (const char* damping : {"1", "3", "5"}) {
        const std::string key = fmt::format("chain.damping_kg_per_s={}", damping);
        const auto row = hertzline(with(with({"sweep"}, scene), {"--vary", key, "--json"})).json();
        EXPECT_EQ(row["status"], "ok");
        EXPECT_EQ(row["estimated_over_s"], 0.0005);
        const std::string step = fmt::format("numerics.step_s={}", row["step_s"].get<double>());
        const Outcome run = hertzline(with(with({"run"}, scene), {"--set", key, "--set", step, "--json"}));
        ASSERT_EQ(run.status, 0) << run.err;
        EXPECT_EQ(run.json()["peak_v_last_m_per_s"], row["peak_v_last_m_per_s"]);
    }
}

TEST(Sweep, KeepsTheQuantitiesThatAreNamed) {
    const Outcome outcome =
        hertzline(with(quick_sweep, {"--vary", "chain.spheres=3", "--json", "--quantity",
                                     "peak_v_out_m_per_s,harmonics_db", "--quantity", "steps"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto row = Json::parse(outcome.out);
    Words names;
    for (const auto& [name, value] : row.items()) {
        names.push_back(name);
    }
    EXPECT_THAT(
        names, testing::ElementsAre("point", "chain.spheres", "status", "estimated_error", "estimated_over_s",
                                    "peak_v_out_m_per_s", "harmonics_db_1", "harmonics_db_2",
                                    "harmonics_db_3", "harmonics_db_4", "harmonics_db_5", "harmonics_db_6",
                                    "harmonics_db_7", "harmonics_db_8", "harmonics_db_9", "harmonics_db_10",
                                    "steps", "integrator", "scene_hash", "message"));
    EXPECT_TRUE(row["steps"].is_number_integer());
}

TEST(Sweep, WrongUseIsToldBeforeAnythingRuns) {
    const TemporaryFolder folder;
    const auto fault = [&](const Words& more) {
        const Outcome outcome = hertzline(with({"sweep"}, more));
        EXPECT_EQ(outcome.status, 2) << testing::PrintToString(more);
        EXPECT_THAT(outcome.out, testing::IsEmpty());
        return outcome.err;
    };
    const Words vary{"paper-wall", "--vary", "chain.spheres=3,4"};
    EXPECT_THAT(fault({"paper-wall", "--vary", "chain.sphere=3..1", "--jobs", "0x"}), HasSubstr("--jobs"));
    EXPECT_THAT(fault({"paper-wall", "--vary", "chain.sphere=3", "--jobs", "-1", "--shard", "3/2",
                       "--band-from", "-1"}),
                AllOf(HasSubstr("-o FILE is missing"), HasSubstr("--jobs: found -1"),
                      HasSubstr("--shard: found \"3/2\""), HasSubstr("--band-from"),
                      HasSubstr("did you mean 'chain.spheres'?")));
    EXPECT_THAT(fault(with(vary, {"--json", "--jobs", "0"})),
                HasSubstr("--jobs: found 0, allowed: 1 to 1024"));
    EXPECT_THAT(fault({"--json"}), HasSubstr("SCENE"));
    EXPECT_THAT(fault({"paper-wall", "--json"}), HasSubstr("--vary or --points"));
    EXPECT_THAT(fault(with(vary, {"-o", folder.file("a.txt")})), HasSubstr(".csv, .h5"));
    EXPECT_THAT(fault(with(vary, {"-o", folder.file("a.csv"), "--waveforms", "v_last"})), HasSubstr(".h5"));
    EXPECT_THAT(fault(with(vary, {"--json", "--measure", "v_plate"})),
                HasSubstr("--measure: found \"v_plate\""));
    EXPECT_THAT(fault(with(vary, {"--json", "--quantity", "thd"})), HasSubstr("--quantity: found \"thd\""));
    EXPECT_THAT(fault(with(vary, {"--json", "--set", "chain.spheres=5"})), HasSubstr("a key that varies"));
    EXPECT_THAT(fault(with(vary, {"--json", "--resume"})), HasSubstr("--resume needs -o FILE"));
    const std::string epoxy = folder.file("epoxy.toml");
    write_text(epoxy,
               "[materials.epo]\nyoungs_modulus_pa = 8e9\npoissons_ratio = 0.33\ndensity_kg_per_m3 = 2100\n");
    EXPECT_THAT(fault({epoxy, "--vary", "materials.epo.density=2e3,3e3", "--set",
                       "materials.epo.density_kg_per_m3=5e3", "--json"}),
                HasSubstr("a key that varies"));
    EXPECT_THAT(fault({epoxy, "--vary", "materials.epo.density_kg_per_m3=2e3,3e3", "--set",
                       "materials.epo.density=5e3", "--json"}),
                HasSubstr("a key that varies"));
    for (const Words& option : {Words{"--resume"}, Words{"--band-from", "3"}, Words{"--jobs", "1"}}) {
        EXPECT_THAT(fault(with({"--merge", "x.journal", "-o", "x.h5"}, option)),
                    HasSubstr("--merge: found options"));
    }
    const Outcome nowhere = hertzline(with({"sweep"}, with(vary, {"-o", folder.file("no/a.csv")})));
    EXPECT_EQ(nowhere.status, 1);
    EXPECT_THAT(nowhere.err, HasSubstr("no/a.csv"));
    const std::string points = folder.file("points.csv");
    write_text(points, "chain.preload_n\n0.1\n");
    EXPECT_THAT(fault({"paper-wall", "--points", points, "-o", points}),
                HasSubstr("found a file that is read here"));
    EXPECT_EQ(contents(points), "chain.preload_n\n0.1\n");
    const Outcome absent = hertzline({"sweep", "paper-wall", "--points", folder.file("none.csv"), "--json"});
    EXPECT_EQ(absent.status, 1);
    EXPECT_THAT(absent.err, HasSubstr("none.csv"));
}

TEST(Sweep, WhatCannotFitIsRefusedBeforeItBegins) {
    const TemporaryFolder folder;
    const auto sweep = [&](const std::string& duration_s, const std::string& jobs) {
        return hertzline({"sweep", "paper-wall", "--vary", "chain.preload_n=0.1..1:100000", "--vary",
                          "chain.spheres=2..5:4", "--waveforms", "v_last", "--jobs", jobs, "--set",
                          "output.duration_s=" + duration_s, "-o", folder.file("a.h5")});
    };
    const Outcome disk = sweep("1.2", "1");
    EXPECT_EQ(disk.status, 1);
    EXPECT_THAT(disk.err, AllOf(HasSubstr("TiB of disk"), HasSubstr("is free")));
    const Outcome memory = sweep("26", "1024");
    EXPECT_EQ(memory.status, 1);
    EXPECT_THAT(memory.err, AllOf(HasSubstr("TiB of memory"), HasSubstr("fewer --jobs")));
    EXPECT_FALSE(fs::exists(folder.file("a.h5.journal")));
}

TEST(Sweep, TakesAListOfPoints) {
    const TemporaryFolder folder;
    write_text(folder.file("p.csv"), "chain.spheres,chain.preload_n\n3,0.1\n5,0.2\n");
    const Outcome outcome = hertzline(with(quick_sweep, {"--points", folder.file("p.csv"), "--json"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(rows_of(outcome).at(1)["chain.spheres"], 5);
    EXPECT_EQ(rows_of(outcome).at(1)["chain.preload_n"], 0.2);
}

TEST(Sweep, ASceneMayLackWhatVaries) {
    const TemporaryFolder folder;
    const Words lacking = with(quick_sweep, {"--set", "chain.damping_law=tsuji"});
    const auto alphas = [&](const Words& more) {
        const Outcome outcome = hertzline(with(lacking, with(more, {"--json"})));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::vector<double> values;
        for (const json& row : rows_of(outcome)) {
            EXPECT_EQ(row["status"], "ok");
            values.push_back(row["chain.damping_alpha"]);
        }
        return values;
    };
    EXPECT_THAT(alphas({"--vary", "chain.damping_alpha=0.1,0.3"}), ElementsAre(0.1, 0.3));
    EXPECT_THAT(alphas({"--vary", "chain.damping_alpha = .1..0.3:2"}), ElementsAre(0.1, 0.3));
    const Outcome wrong = hertzline(with(lacking, {"--vary", "chain.damping_alpha=-1,0.1", "--json"}));
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("chain.damping_alpha: found -1"));
    write_text(folder.file("p.csv"), "chain.spheres,\"chain.damping_alpha\"\n3,0.1\n5,0.3\n");
    EXPECT_THAT(alphas({"--points", folder.file("p.csv")}), ElementsAre(0.1, 0.3));
    const Outcome still = hertzline(with(lacking, {"--vary", "chain.spheres=3,5", "--json"}));
    EXPECT_EQ(still.status, 2);
    EXPECT_THAT(still.err, HasSubstr("chain.damping_alpha"));
}

TEST(Sweep, ALiveDriveIsRefusedAsRunDoes) {
    const Outcome outcome = hertzline(
        with(quick_sweep, {"--vary", "drive.kind=tone,live", "--set", "drive.sample_rate_hz=1e6", "--json"}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json live = rows_of(outcome).at(1);
    EXPECT_EQ(live["status"], "refused");
    EXPECT_THAT(live["message"].get<std::string>(), HasSubstr("drive.kind: found \"live\" without samples"));
}

TEST(Sweep, IsDrawn) {
    const TemporaryFolder folder;
    const auto drawn = [&](const std::string& table, const Words& sweep, const Words& plot) {
        const Outcome swept = hertzline(with(with(quick_sweep, sweep), {"-o", folder.file(table)}));
        EXPECT_EQ(swept.status, 0) << swept.err;
        const Outcome outcome =
            hertzline(with({"plot", folder.file(table), "-o", folder.file(table + ".svg")}, plot));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return contents(folder.file(table + ".svg"));
    };
    const std::string curve = drawn("c.csv", {"--vary", "drive.repetition_hz=0,100,40000"}, {});
    EXPECT_THAT(curve, AllOf(HasSubstr("<!-- drive.repetition_hz [Hz] -->"), HasSubstr("<!-- refused -->"),
                             HasSubstr("<!-- peak_v_out_m_per_s [m/s] -->")));
    const std::string map =
        drawn("m.h5", {"--vary", "chain.preload_n=0.1..1:log:3", "--vary", "chain.spheres=3..5:3"},
              {"--quantity", "thd_r"});
    EXPECT_THAT(map, AllOf(HasSubstr("<!-- chain.preload_n [N] -->"), HasSubstr("<!-- chain.spheres -->"),
                           HasSubstr("<!-- thd_r -->"), Not(HasSubstr("occupied"))));
    const Outcome wrong =
        hertzline({"plot", folder.file("m.h5"), "-o", folder.file("w.png"), "--quantity", "x"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("--quantity: found x"));
    hertzline({"run", "paper-wall", "-o", folder.file("r.h5")});
    const Outcome recording =
        hertzline({"plot", folder.file("r.h5"), "-o", folder.file("w.png"), "--quantity", "thd_r"});
    EXPECT_EQ(recording.status, 2);
    EXPECT_THAT(recording.err, HasSubstr("found no sweep"));
}

}  // namespace

}  // namespace hertzline::test
