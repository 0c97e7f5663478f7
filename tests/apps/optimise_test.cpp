// hertzline optimise: its answer, its file, its journal, and refused requests.

#include <cmath>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/journal_rows.hpp"
#include "tests/apps/limit.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/quick_points.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A quick search: a short chain on a wall, and few samples.
const Words search_scene = with({"optimise"}, quick_points);
const Words search_axes{"--vary", "chain.preload_n=0.01..1:log", "--vary", "chain.spheres=3..8"};
const Words quick_search =
    with(with(search_scene, search_axes), {"--maximise", "peak_v_out_m_per_s", "--evaluations", "120"});

class Optimise : public testing::Test {
protected:
    Outcome optimised(const std::string& name, const Words& more = {}, const Words& words = quick_search) {
        return hertzline(with(words, with(more, {"-o", folder.file(name)})));
    }
    std::string fault(const Words& words) {
        const Outcome outcome = hertzline(words);
        EXPECT_EQ(outcome.status, 2) << testing::PrintToString(words);
        EXPECT_THAT(outcome.out, IsEmpty());
        return outcome.err;
    }

    TemporaryFolder folder;
};

TEST_F(Optimise, TellsTheBestOfItsRows) {
    const Outcome outcome =
        optimised("s.csv", {"--json", "--subject-to", "peak_contact_force_n <= 4", "--seed", "3"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json summary = outcome.json();
    EXPECT_LE(summary["evaluations"], 120);
    EXPECT_GT(summary["feasible"], 10);
    const json& starts = summary["starts"];
    EXPECT_GE(starts["starts"], 2);
    EXPECT_GE(starts["starts_at_best"], 1);
    EXPECT_LE(starts["starts_ended"], starts["starts"]);
    EXPECT_GE(summary["best"]["peak_v_out_m_per_s"], starts["starts_median"]);
    EXPECT_GT(starts["starts_median"], starts["starts_worst"]);
    EXPECT_TRUE(summary["around"].contains("chain.preload_n.minus_1_percent") ||
                summary["around"].contains("chain.preload_n.plus_1_percent"));
    const json& best = summary["best"];
    EXPECT_LE(best["peak_contact_force_n"], 4);
    EXPECT_EQ(best["status"], "ok");

    std::istringstream rows(contents(folder.file("s.csv")));
    std::string line;
    std::int64_t count = -1;  // without the head
    std::string best_row;
    while (std::getline(rows, line)) {
        if (line.starts_with(std::to_string(best["point"].get<int>()) + ',')) {
            best_row = line;
        }
        ++count;
    }
    EXPECT_EQ(count, summary["evaluations"]);
    EXPECT_THAT(best_row, HasSubstr(best["peak_v_out_m_per_s"].dump()));
    const json metadata = json::parse(contents(folder.file("s.csv-metadata.json")));
    const json& search = metadata["urn:hertzline:provenance"]["search"];
    EXPECT_EQ(search["maximise"], "peak_v_out_m_per_s");
    EXPECT_EQ(search["subject_to"][0], "peak_contact_force_n <= 4");
    EXPECT_EQ(search["best_point"], best["point"]);
    EXPECT_FALSE(fs::exists(folder.file("s.csv.journal")));
}

TEST_F(Optimise, TheNeighboursOfTheBestHaveTheValuesThatRunGives) {
    const json summary = optimised("n.csv", {"--json"}).json();
    const double preload = summary["best"]["chain.preload_n"];
    const std::int64_t spheres = summary["best"]["chain.spheres"];
    std::size_t compared = 0;
    const auto compare = [&](const std::string& name, double preload_there, std::int64_t spheres_there) {
        if (!summary["around"].contains(name)) {
            return;  // beyond the range
        }
        const json of_run =
            hertzline(with(with({"run"}, quick_points),
                           {"--json", "--set", "chain.preload_n=" + json(preload_there).dump(), "--set",
                            "chain.spheres=" + std::to_string(spheres_there)}))
                .json();
        const double value = of_run["peak_v_out_m_per_s"];
        // points have steps of their own, within the accuracy
        EXPECT_NEAR(summary["around"][name].get<double>(), value, 5e-5 * value) << name;
        ++compared;
    };
    for (const int percent : {-5, -1, 1, 5}) {
        compare("chain.preload_n." + std::string(percent < 0 ? "minus_" : "plus_") +
                    std::to_string(std::abs(percent)) + "_percent",
                preload * (1 + percent / 100.0), spheres);
    }
    compare("chain.spheres.minus_1", preload, spheres - 1);
    compare("chain.spheres.plus_1", preload, spheres + 1);
    EXPECT_GE(compared, 3U);
    EXPECT_EQ(summary["around"].size(), compared + 1);  // and the worst of them
}

TEST_F(Optimise, GivesTheSameBytesWhateverTheJobs) {
    for (const std::string ending : {".csv", ".h5"}) {
        ASSERT_EQ(optimised("one" + ending, {"--jobs", "1"}).status, 0);
        ASSERT_EQ(optimised("two" + ending, {"--jobs", "2"}).status, 0);
        EXPECT_GT(contents(folder.file("one" + ending)).size(), 5'000U);
        EXPECT_EQ(contents(folder.file("one" + ending)), contents(folder.file("two" + ending)));
    }
    ASSERT_EQ(optimised("other.csv", {"--seed", "2"}).status, 0);
    EXPECT_NE(contents(folder.file("one.csv")), contents(folder.file("other.csv")));
}

TEST_F(Optimise, GoesOnWherePointsFail) {
    const Outcome outcome =
        hertzline(with(search_scene, {"--vary", "drive.repetition_hz=0,1000,60000", "--vary",
                                      "chain.preload_n=0.1..1", "--minimise", "peak_v_out_m_per_s",
                                      "--evaluations", "60", "--json", "-o", folder.file("m.csv")}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_GT(outcome.json()["refused"], 0);
    EXPECT_THAT(outcome.err, HasSubstr("cannot be simulated"));
    EXPECT_NE(outcome.json()["best"]["drive.repetition_hz"], 60000);
}

TEST_F(Optimise, WithoutAFeasiblePointSaysHowFarTheClosestIs) {
    const Outcome outcome =
        optimised("n.csv", {"--subject-to", "peak_v_last_m_per_s >= 100", "--subject-to", "thd_r >= 0"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("none of "), HasSubstr("the closest is point "),
                                   HasSubstr("where peak_v_last_m_per_s >= 100 is required"),
                                   Not(HasSubstr("thd_r >= 0"))));
    EXPECT_THAT(outcome.out, HasSubstr("feasible     0"));
    EXPECT_TRUE(fs::exists(folder.file("n.csv")));
}

TEST_F(Optimise, SaysWhichNumberNoPointHas) {
    const Outcome outcome =
        hertzline(with(search_scene, {"--vary", "chain.preload_n=0.1..1", "--maximise", "switching_db_5",
                                      "--evaluations", "18", "-o", folder.file("n.csv")}));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("of the goal and the bounds: all lack switching_db_5"));
}

TEST_F(Optimise, SaysWhenTheBestPointIsAtALimit) {
    const Outcome outcome = hertzline(
        with(search_scene, {"--vary", "drive.amplitude_m=1um..2um", "--maximise", "peak_v_last_m_per_s",
                            "--evaluations", "30", "-o", folder.file("l.csv")}));
    EXPECT_THAT(outcome.err, HasSubstr("the best point lies at the upper limit of drive.amplitude_m"));
    const Outcome list = hertzline(with(search_scene, {"--vary", "chain.spheres=3,4", "--maximise", "thd_r",
                                                       "--evaluations", "30", "-o", folder.file("m.csv")}));
    EXPECT_THAT(list.err, AllOf(Not(HasSubstr("the best point lies at")), Not(HasSubstr("another seed"))));
}

TEST_F(Optimise, SaysWhenOneLocalSearchAloneFoundTheBestPoint) {
    const Outcome few =
        hertzline(with(with(search_scene, search_axes), {"--maximise", "peak_v_out_m_per_s", "--evaluations",
                                                         "36", "--json", "-o", folder.file("f.csv")}));
    EXPECT_EQ(few.json()["starts"]["starts_at_best"], 1);
    EXPECT_THAT(few.err, HasSubstr("fewer than two local searches reached the best value"));
    const Outcome slope =
        hertzline(with(search_scene, {"--vary", "drive.amplitude_m=1um..2um", "--maximise",
                                      "peak_v_last_m_per_s", "--json", "-o", folder.file("m.csv")}));
    EXPECT_GE(slope.json()["starts"]["starts_at_best"], 2);
    EXPECT_THAT(slope.err, Not(HasSubstr("fewer than two local searches")));
}

TEST_F(Optimise, IsDrawn) {
    ASSERT_EQ(optimised("p.h5").status, 0);
    const Outcome drawn = hertzline({"plot", folder.file("p.h5"), "-o", folder.file("p.svg")});
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    EXPECT_THAT(contents(folder.file("p.svg")),
                AllOf(HasSubstr("<!-- chain.preload_n [N] -->"), HasSubstr("<!-- chain.spheres -->"),
                      HasSubstr("<!-- peak_v_out_m_per_s [m/s] -->"), HasSubstr("<!-- evaluation -->")));
}

/// A long search, to be interrupted.
class LongSearch : public Optimise {
protected:
    Outcome interrupt(int signal) {
        Program program(with(words, {"--jobs", "1"}));  // it takes long enough on any machine
        wait_for_rows(journal);
        program.send(signal);
        return program.wait();
    }
    void expect_resumed(const Words& more = {}) {
        const Outcome outcome = hertzline(with(words, with({"--resume", "--json"}, more)));
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_FALSE(fs::exists(journal));
        const Outcome undisturbed =
            optimised("u.csv", {"--json"}, with(long_words, {"--evaluations", evaluations}));
        ASSERT_EQ(undisturbed.status, 0);
        EXPECT_EQ(contents(file), contents(folder.file("u.csv")));
        EXPECT_EQ(outcome.json()["best"], undisturbed.json()["best"]);
        EXPECT_EQ(outcome.json()["starts"], undisturbed.json()["starts"]);
    }

    static constexpr const char* evaluations = "3000";
    std::string file = folder.file("s.csv");
    std::string journal = file + ".journal";
    Words long_words = with(with(search_scene, search_axes), {"--maximise", "peak_v_out_m_per_s"});
    Words words = with(long_words, {"--evaluations", evaluations, "-o", file});
};

TEST_F(LongSearch, GoesOnAfterItWasKilled) {
    EXPECT_EQ(interrupt(SIGKILL).status, -1);
    EXPECT_FALSE(fs::exists(file));
    expect_resumed({"--jobs", "3"});
}

TEST_F(LongSearch, CtrlCSavesWhatThereIs) {
    const Outcome outcome = interrupt(SIGINT);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("which are in " + journal), HasSubstr("--resume")));
    EXPECT_THAT(hertzline(words).err, HasSubstr("--resume to continue it"));
    const Outcome other = hertzline(with(words, {"--resume", "--seed", "5"}));
    EXPECT_EQ(other.status, 2);
    EXPECT_THAT(other.err, HasSubstr("found the --seed 1 where this search has 5"));
    const Outcome sweep =
        hertzline({"sweep", "paper-wall", "--vary", "chain.spheres=3,4", "-o", file, "--resume"});
    EXPECT_EQ(sweep.status, 2);
    EXPECT_THAT(sweep.err, HasSubstr("found one of a search, allowed: the journal of the same sweep"));
    expect_resumed();
}

TEST_F(LongSearch, AFileInUseByAnotherSearchIsRefused) {
    interrupt(SIGINT);
    Program other(with(words, {"--resume"}));
    other.messages_with("evaluations at most");
    const Outcome outcome = hertzline(with(words, {"--resume"}));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr(journal + " is in use by another sweep or search"));
}

/// Returns the lines of a table, without their provenance.
std::vector<std::string> lines_of(const std::string& name) {
    std::istringstream text(contents(name));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) {
        lines.push_back(line);
    }
    return lines;
}

TEST_F(LongSearch, FinishedGoesOnWithMoreEvaluations) {
    for (const std::string name : {"g.csv", "g.h5"}) {
        const auto searched = [&](const char* most, const Words& more) {
            return optimised(name, with({"--json", "--evaluations", most}, more), long_words);
        };
        ASSERT_EQ(searched("60", {}).status, 0);
        const std::string first = contents(folder.file(name));
        const Outcome more = searched("150", {"--resume"});
        ASSERT_EQ(more.status, 0) << more.err;
        EXPECT_THAT(more.err, HasSubstr("the search continues from them"));
        EXPECT_GT(more.json()["evaluations"], 60);
        EXPECT_LE(more.json()["evaluations"], 150);
        EXPECT_FALSE(fs::exists(folder.file(name + ".journal")));
        if (name == "g.csv") {
            EXPECT_THAT(contents(folder.file(name)), testing::StartsWith(first));
        }
        const Outcome again = searched("150", {"--resume"});
        EXPECT_EQ(again.status, 0);
        EXPECT_THAT(again.err, HasSubstr(name + " is complete with"));
        EXPECT_EQ(again.json(), more.json());
        EXPECT_THAT(searched("60", {"--resume"}).err, HasSubstr(name + " is complete with"));
        const Outcome other = searched("150", {"--resume", "--seed", "5"});
        EXPECT_EQ(other.status, 2);
        EXPECT_THAT(other.err, HasSubstr("found the --seed 1 where this search has 5"));
        ASSERT_EQ(searched("200", {"--resume"}).status, 0);
    }
}

TEST_F(LongSearch, ThatGoesOnIsResumedToTheSameBytes) {
    const auto searched = [&](const std::string& name, const Words& more) {
        return optimised(name, more, long_words);
    };
    for (const char* name : {"s.csv", "w.csv"}) {
        ASSERT_EQ(searched(name, {"--evaluations", "60"}).status, 0);
    }
    const Words more{"--evaluations", evaluations, "--resume"};
    words = with(long_words, with(more, {"-o", file}));
    interrupt(SIGKILL);
    ASSERT_TRUE(fs::exists(journal));
    ASSERT_EQ(searched("s.csv", more).status, 0);
    ASSERT_EQ(searched("w.csv", more).status, 0);
    EXPECT_EQ(lines_of(file), lines_of(folder.file("w.csv")));
}

TEST_F(LongSearch, AFullDiskLosesNoRow) {
    {
        const Limit limit(RLIMIT_FSIZE, 400'000);
        const Outcome outcome = hertzline(words);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_THAT(outcome.err, AllOf(HasSubstr("cannot write " + journal), HasSubstr("File too large"),
                                       HasSubstr("--resume continues")));
    }
    expect_resumed();
}

TEST_F(Optimise, WrongUseIsToldBeforeAnythingRuns) {
    const Words maximise{"--maximise", "peak_v_out_m_per_s"};
    const Words sound = with(with(search_scene, search_axes), maximise);
    const Words output{"-o", folder.file("w.csv")};
    EXPECT_THAT(fault({"optimise", "-o", "x.h5"}), HasSubstr("SCENE is missing"));
    EXPECT_THAT(fault(sound), HasSubstr("-o FILE is missing"));
    EXPECT_THAT(fault(with(sound, {"-o", "a.txt"})), HasSubstr(".csv, .h5"));
    EXPECT_THAT(fault(with(with(search_scene, maximise), output)), HasSubstr("--vary is missing"));
    EXPECT_THAT(fault(with(with(search_scene, search_axes), output)),
                HasSubstr("--maximise or --minimise is missing"));
    EXPECT_THAT(fault(with(sound, with(output, {"--minimise", "thd_r"}))),
                HasSubstr("--maximise and --minimise: found both"));
    EXPECT_THAT(fault(with(with(search_scene, search_axes), with(output, {"--maximise", "peak_v_out"}))),
                AllOf(HasSubstr("--maximise: found \"peak_v_out\""),
                      HasSubstr("did you mean 'peak_v_out_m_per_s'?")));
    EXPECT_THAT(fault(with(sound, with(output, {"--subject-to", "thd >= 1"}))),
                HasSubstr("--subject-to: found \"thd\""));
    EXPECT_THAT(fault(with(sound, with(output, {"--subject-to", "thd_r == 1"}))),
                HasSubstr("allowed: \"MEASURE >= NUMBER\""));
    EXPECT_THAT(fault(with(sound, with(output, {"--vary", "chain.sphere=3..4"}))),
                HasSubstr("did you mean 'chain.spheres'?"));
    EXPECT_THAT(fault(with(sound, with(output, {"--vary", "chain.damping_kg_per_s=0.4..0.3"}))),
                HasSubstr("a range that goes up"));
    EXPECT_THAT(fault(with(sound, with(output, {"--vary", "chain.damping_kg_per_s=0.3..0.4:5"}))),
                HasSubstr("without a count"));
    EXPECT_THAT(fault(with(sound, with(output, {"--set", "chain.spheres=5"}))),
                HasSubstr("a key that varies"));
    EXPECT_THAT(fault(with(sound, with(output, {"--evaluations", "10"}))),
                HasSubstr("--evaluations: found 10, allowed: 36 to 1000000, where 2 keys vary"));
    EXPECT_THAT(fault(with(sound, with(output, {"--evaluations", "-3", "--jobs", "0"}))),
                AllOf(HasSubstr("--evaluations: found -3"), HasSubstr("--jobs: found 0")));
    for (const char* seed : {"x", "-1", "1.5", "99999999999999999999"}) {
        EXPECT_THAT(fault(with(sound, with(output, {"--seed", seed}))),
                    AllOf(HasSubstr("--seed"), HasSubstr("a whole number from 0 to 18446744073709551615")));
    }
    EXPECT_THAT(fault(with(sound, with(output, {"--subject-to", "thd >= 1", "--subject-to", "thd_r = 1"}))),
                AllOf(HasSubstr("--subject-to: found \"thd\""), HasSubstr("thd_r = 1")));
    EXPECT_THAT(fault({"optimise", "paper-wall", "--vary", "chain.sphere=1", "--subject-to", "x"}),
                AllOf(HasSubstr("-o FILE is missing"), HasSubstr("--maximise or --minimise is missing"),
                      HasSubstr("--subject-to: found \"x\""), HasSubstr("did you mean 'chain.spheres'?")));
    const Outcome nowhere = hertzline(with(sound, {"-o", folder.file("no/a.csv")}));
    EXPECT_EQ(nowhere.status, 1);
    EXPECT_THAT(nowhere.err, HasSubstr("no/a.csv"));
    EXPECT_TRUE(fs::is_empty(folder.file("")));
}

}  // namespace

}  // namespace hertzline::test
