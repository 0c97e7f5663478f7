// The files of hertzline sweep: journals, shards, and the remains of a sweep that was stopped early.

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/journal_rows.hpp"
#include "tests/apps/limit.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/quick_points.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class SweepFiles : public testing::Test {
protected:
    /// Runs the sweep into a file of that name. Returns the finished file.
    std::string file_of(const std::string& name, const Words& more = {}) {
        const Outcome outcome = hertzline(with(words, with(more, {"-o", folder.file(name)})));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_FALSE(fs::exists(folder.file(name + ".journal")));
        return contents(folder.file(name));
    }

    TemporaryFolder folder;
    Words words =
        with(quick_sweep, {"--vary", "chain.preload_n=0.01..1:log:8", "--vary", "chain.spheres=3..6:4"});
};

TEST_F(SweepFiles, HaveTheSameBytesWhateverTheJobsAndShards) {
    for (const std::string ending : {".csv", ".h5"}) {
        const std::string one = file_of("one" + ending, {"--jobs", "1"});
        EXPECT_GT(one.size(), 5'000U);
        EXPECT_EQ(file_of("four" + ending, {"--jobs", "4"}), one);
        Words merge{"sweep", "--merge"};
        for (const char* part : {"3", "1", "2"}) {
            const Outcome outcome = hertzline(with(words, {"-o", folder.file("parts" + ending), "--shard",
                                                           std::string(part) + "/3", "--jobs", "2"}));
            ASSERT_EQ(outcome.status, 0) << outcome.err;
            EXPECT_FALSE(fs::exists(folder.file("parts" + ending)));
            merge.push_back(folder.file(fmt::format("parts{}.{}-of-3.journal", ending, part)));
        }
        const Outcome merged = hertzline(with(merge, {"-o", folder.file("merged" + ending)}));
        ASSERT_EQ(merged.status, 0) << merged.err;
        EXPECT_EQ(contents(folder.file("merged" + ending)), one);
    }
}

TEST_F(SweepFiles, OfPartsThatAreNotAllThereAreRefused) {
    for (const char* part : {"1/2", "2/2"}) {
        hertzline(with(words, {"-o", folder.file("a.csv"), "--shard", part}));
    }
    hertzline(with(words, {"-o", folder.file("b.csv"), "--shard", "1/2", "--set", "chain.material=steel"}));
    const std::string first = folder.file("a.csv.1-of-2.journal");
    const std::string second = folder.file("a.csv.2-of-2.journal");
    const auto merge = [&](const Words& journals) {
        return hertzline(with(with({"sweep", "--merge"}, journals), {"-o", folder.file("m.csv")}));
    };
    EXPECT_THAT(merge({first}).err, HasSubstr("the journal of part 2/2 is missing"));
    EXPECT_THAT(merge({first, first}).err, HasSubstr("allowed: each file once"));
    fs::copy_file(first, folder.file("copy"));
    EXPECT_THAT(merge({first, folder.file("copy")}).err, HasSubstr("found part 1/2 again"));
    EXPECT_THAT(merge({second, folder.file("b.csv.1-of-2.journal")}).err,
                AllOf(HasSubstr("another scene"), HasSubstr("parts of one sweep")));
    ASSERT_EQ(std::system(fmt::format("/usr/bin/python3 -c 'import sqlite3; c = sqlite3.connect(\"{}\"); "
                                      "c.execute(\"DELETE FROM points WHERE point = 3\"); c.commit()'",
                                      second)
                              .c_str()),
              0);
    const Outcome short_of_one = merge({first, second});
    EXPECT_EQ(short_of_one.status, 1);
    EXPECT_THAT(short_of_one.err, AllOf(HasSubstr(second + " lacks point 3"), HasSubstr("--resume")));
    fs::resize_file(second, fs::file_size(second) / 2);
    const Outcome torn = merge({first, second});
    EXPECT_EQ(torn.status, 1);
    EXPECT_THAT(torn.err, HasSubstr("cannot read " + second));
    EXPECT_FALSE(fs::exists(folder.file("m.csv")));
}

class LongSweep : public testing::Test {
protected:
    static constexpr int points = repeated(6000);
    /// Leaves a journal with some rows, of a program that was ended by a signal.
    Outcome interrupt(int signal) {
        Program program(with(words, {"-o", file, "--jobs", "1"}));  // it takes long enough on any machine
        wait_for_rows(journal);
        program.send(signal);
        return program.wait();
    }

    /// Returns the file of an undisturbed sweep.
    std::string undisturbed() {
        const Outcome outcome = hertzline(with(words, {"-o", folder.file("u.csv")}));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return contents(folder.file("u.csv"));
    }

    void expect_resumed(const Words& more = {}) {
        const Outcome outcome = hertzline(with(words, with({"-o", file, "--resume"}, more)));
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(fmt::format("of {} points are in {}", points, journal)));
        EXPECT_EQ(contents(file), undisturbed());
        EXPECT_FALSE(fs::exists(journal));
    }

    TemporaryFolder folder;
    std::string file = folder.file("s.csv");
    std::string journal = file + ".journal";
    Words words = with(quick_sweep, {"--vary", fmt::format("chain.preload_n=0.01..1:log:{}", points)});
};

TEST_F(LongSweep, GoesOnAfterItWasKilled) {
    EXPECT_EQ(interrupt(SIGKILL).status, -1);
    EXPECT_FALSE(fs::exists(file));
    expect_resumed({"--jobs", "3"});
}

TEST_F(LongSweep, CtrlCSavesWhatThereIs) {
    const Outcome outcome = interrupt(SIGINT);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(fmt::format("of {} points, which are in {}", points, journal)),
                                   HasSubstr("--resume")));
    const Outcome again = hertzline(with(words, {"-o", file}));
    EXPECT_EQ(again.status, 1);
    EXPECT_THAT(again.err, AllOf(HasSubstr(journal), HasSubstr("--resume to continue it")));
    expect_resumed();
}

TEST_F(LongSweep, GoesOnWhereverItWasKilled) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    for (int kill = 0; kill < 6; ++kill) {
        Program program(with(words, {"-o", file, "--resume"}));
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 250));
        program.send(SIGKILL);
        program.wait();
    }
    const Outcome outcome = hertzline(with(words, {"-o", file, "--resume"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(contents(file), undisturbed());
}

TEST_F(LongSweep, IsReadByOtherProgramsWhileItRuns) {
    Program program(with(words, {"-o", file}));
    wait_for_rows(journal);
    {
        const studies::Database reader(journal, studies::Database::Use::read);
        reader.wait_for_others(1000);
        studies::Statement rows(reader, "SELECT status FROM points");
        ASSERT_TRUE(rows.step());
        std::this_thread::sleep_for(std::chrono::milliseconds(500));  // a reader that takes its time
        int others = 0;
        for (; rows.step(); ++others) {
            EXPECT_EQ(rows.text(0), "ok");
        }
        EXPECT_GE(others, 49);
    }
    EXPECT_EQ(program.wait().status, 0);
    EXPECT_EQ(contents(file), undisturbed());
}

TEST_F(LongSweep, WhenFinishedIsLeftAsItIs) {
    for (const std::string name : {"s.csv", "s.h5"}) {
        const Words command = with(words, {"-o", folder.file(name), "--resume"});
        ASSERT_EQ(hertzline(command).status, 0);
        const auto before = fs::last_write_time(folder.file(name));
        const Outcome again = hertzline(command);
        EXPECT_EQ(again.status, 0);
        EXPECT_THAT(again.err, HasSubstr(name + " is complete, and stays as it is"));
        EXPECT_THAT(again.out, HasSubstr(fmt::format("points      {}", points)));
        EXPECT_EQ(fs::last_write_time(folder.file(name)), before);
        EXPECT_FALSE(fs::exists(folder.file(name + ".journal")));
        const Outcome other = hertzline(with(command, {"--set", "chain.spheres=4"}));
        EXPECT_EQ(other.status, 2);
        EXPECT_THAT(other.err,
                    AllOf(HasSubstr("found another scene"), HasSubstr("without --resume it is replaced")));
        EXPECT_EQ(fs::last_write_time(folder.file(name)), before);
        for (const Words& beside : {Words{}, Words{"--set", "chain.spheres=4"}}) {
            const Outcome second = hertzline(with(with(command, {"-o", folder.file("other.csv")}), beside));
            EXPECT_EQ(second.status, 2);
            EXPECT_THAT(second.err, HasSubstr(beside.empty() ? "other.csv: found no file, beside another one"
                                                             : "found another scene"));
            EXPECT_FALSE(fs::exists(folder.file("other.csv")));
            EXPECT_EQ(fs::last_write_time(folder.file(name)), before);
        }
    }
}

TEST_F(LongSweep, WhenFinishedWithOtherWaveformsIsRefused) {
    const std::string name = folder.file("w.h5");
    const Words command = with(words, {"-o", name, "--resume"});
    ASSERT_EQ(hertzline(with(command, {"--waveforms", "v_last"})).status, 0);
    EXPECT_EQ(hertzline(with(command, {"--waveforms", "v_last"})).status, 0);
    for (const Words& others : {Words{}, Words{"--waveforms", "v_out"}}) {
        const Outcome other = hertzline(with(command, others));
        EXPECT_EQ(other.status, 2);
        EXPECT_THAT(other.err, HasSubstr("found the --waveforms \"v_last\" where this sweep has"));
    }
}

TEST_F(LongSweep, AJournalOfAnotherSweepIsRefused) {
    interrupt(SIGINT);
    const auto other = [&](const Words& words_of_other) {
        const Outcome outcome = hertzline(with(words_of_other, {"-o", file, "--resume"}));
        EXPECT_EQ(outcome.status, 2);
        return outcome.err;
    };
    EXPECT_THAT(other(with(words, {"--vary", "chain.spheres=3,4"})), HasSubstr("--vary"));
    EXPECT_THAT(other(with(words, {"--set", "chain.spheres=4"})), HasSubstr("found another scene"));
    EXPECT_THAT(other(with(words, {"--measure", "f_last"})), HasSubstr("--measure"));
    EXPECT_THAT(other(with(words, {"--quantity", "thd_r"})), HasSubstr("another --quantity"));
    expect_resumed();
}

TEST_F(LongSweep, AJournalInUseIsRefused) {
    interrupt(SIGINT);
    Program other(with(words, {"-o", file, "--resume"}));
    other.messages_with("points are in");
    const Outcome outcome = hertzline(with(words, {"-o", file, "--resume"}));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr(journal + " is in use by another sweep"));
    EXPECT_EQ(other.wait().status, 0);
    EXPECT_EQ(contents(file), undisturbed());
}

TEST_F(LongSweep, AFullDiskLosesNoRow) {
    {
        const Limit limit(RLIMIT_FSIZE, rlim_t{points} * 400);
        const Outcome outcome = hertzline(with(words, {"-o", file}));
        EXPECT_EQ(outcome.status, 1);
        EXPECT_THAT(outcome.err, AllOf(HasSubstr("cannot write " + journal), HasSubstr("File too large")));
    }
    EXPECT_FALSE(fs::exists(file));
    EXPECT_LE(fs::file_size(journal), std::uintmax_t{points} * 400);
    expect_resumed();
}

TEST(SweepJournal, AFullDiskAtTheEndKeepsTheJournal) {
    const TemporaryFolder folder;
    const std::string file = folder.file("s.csv");
    const Words words = with(quick_sweep, {"--vary", "chain.preload_n=0.1..1:600", "-o", file});
    {
        // rows as text are longer than in the journal
        const Limit limit(RLIMIT_FSIZE, 720'000);
        const Outcome outcome = hertzline(words);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_THAT(outcome.err, HasSubstr("cannot write " + file + ": File too large"));
    }
    EXPECT_FALSE(fs::exists(file));
    const Outcome resumed = hertzline(with(words, {"--resume"}));
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_THAT(resumed.err, HasSubstr("600 of 600 points are in"));
    EXPECT_GT(fs::file_size(file), 720'000U);
}

TEST(SweepJournal, WithoutMemoryForTheLargestPointNothingBegins) {
    if (sanitized) {
        GTEST_SKIP() << "sanitizers take more memory than any limit leaves";
    }
    const TemporaryFolder folder;
    const Words words =
        with(quick_sweep, {"--vary", "chain.spheres=6,1000000,7", "--jobs", "1", "-o", folder.file("s.csv")});
    std::optional<Program> program;
    {
        const Limit limit(RLIMIT_AS, 200'000'000);
        program.emplace(words);  // which inherits it
    }
    const Outcome outcome = program->wait();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("of memory"), HasSubstr("is available"), HasSubstr("--jobs")));
    EXPECT_FALSE(fs::exists(folder.file("s.csv")));
}

}  // namespace

}  // namespace hertzline::test
