// The outputs in recordings, and their scales.

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/recording_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/recorded_columns.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

using namespace recordings;

namespace {

using testing::HasSubstr;

std::vector<std::string> column_names(const std::string& file) {
    std::vector<std::string> names;
    const auto reader = open_reader(file);
    for (const Column& one : reader->head().columns) {
        names.push_back(one.name);
    }
    return names;
}

/// Runs the paper's device, and saves the outputs in all these files.
void run_to(const Words& files, const TemporaryFolder& folder, const Words& more) {
    Words words = with({"run", "paper-vitreous-carbon"}, more);
    for (const std::string& file : files) {
        words.insert(words.end(), {"-o", folder.file(file)});
    }
    const Outcome run = hertzline(words);
    ASSERT_EQ(run.status, 0) << run.err;
}

TEST(SavedColumns, ColumnsSayWhatARunSavesInEveryFormat) {
    const TemporaryFolder folder;
    const Words files{"a.csv", "a.npy", "a.h5", "a.wav", "a.sigmf-meta"};
    run_to(files, folder, {"--columns", "f_last,v_out", "--tap", "v_horn"});
    for (const std::string& file : files) {
        EXPECT_THAT(column_names(folder.file(file)),
                    testing::ElementsAre("v_out_m_per_s", "v_horn_m_per_s", "f_last_n"))
            << file;
    }
    hertzline({"run", "paper-vitreous-carbon", "-o", folder.file("usual.npy")});
    EXPECT_EQ(column(folder.file("a.npy"), "v_out_m_per_s"),
              column(folder.file("usual.npy"), "v_out_m_per_s"));
}

TEST(SavedColumns, ForcesOfAllContactsStandBehindTheSpheres) {
    const TemporaryFolder folder;
    const Words files{"a.csv", "a.npy", "a.h5", "a.sigmf-meta"};
    run_to(files, folder, {"--columns", "f_last,f_chain,v_chain", "--set", "chain.spheres=2"});
    for (const std::string& file : files) {
        EXPECT_THAT(column_names(folder.file(file)),
                    testing::ElementsAre("f_last_n", "v1_m_per_s", "v2_m_per_s", "f1_n", "f2_n", "f3_n"))
            << file;
        EXPECT_EQ(column(folder.file(file), "f3_n"), column(folder.file(file), "f_last_n")) << file;
    }
    const Outcome replay =
        hertzline({"replay", folder.file("a.npy"), "--pace", "flat-out", "--bind", any_port});
    EXPECT_EQ(replay.status, 0) << replay.err;
}

TEST(SavedColumns, ColumnsSayWhatAStreamSavesAlsoOfAllSpheres) {
    const TemporaryFolder folder;
    const Outcome stream = hertzline({"stream", "paper-stream", "--pace", "flat-out", "--duration", "2e-3",
                                      "--bind", any_port, "--record", folder.file("s.npy"), "--columns",
                                      "v_chain,v_horn", "--set", "chain.spheres=2"});
    ASSERT_EQ(stream.status, 0) << stream.err;
    EXPECT_THAT(column_names(folder.file("s.npy")),
                testing::ElementsAre("v_horn_m_per_s", "v1_m_per_s", "v2_m_per_s"));
    const Outcome run =
        hertzline({"run", "paper-stream", "--columns", "v_last,v_horn", "-o", folder.file("r.npy"), "--set",
                   "output.duration_s=2e-3", "--set", "chain.spheres=2"});
    ASSERT_EQ(run.status, 0) << run.err;
    for (const auto& [streamed, ran] :
         {std::pair{"v2_m_per_s", "v_last_m_per_s"}, std::pair{"v_horn_m_per_s", "v_horn_m_per_s"}}) {
        std::vector<double> expected = column(folder.file("r.npy"), ran);
        expected.resize(20'000);
        EXPECT_EQ(column(folder.file("s.npy"), streamed), expected) << streamed;
    }
}

TEST(SavedColumns, AWavThatAudioProgramsWouldCutIsWarnedOfOnceAndScales) {
    const TemporaryFolder folder;
    const Words loud{"--set", "drive.amplitude_m=4e-6", "--columns", "v_last"};
    const auto run = [&](const std::string& file, const Words& more) {
        Words words{"run", "paper-wall", "-o", folder.file(file)};
        words.insert(words.end(), loud.begin(), loud.end());
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = hertzline(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return outcome.err;
    };
    EXPECT_THAT(run("a.wav", {}), testing::ContainsRegex(
                                      "warning: recording .*a.wav: v_last_m_per_s reaches 1[.][0-9]+, beyond "
                                      "the full scale of 1, .*--wav-scale"));
    const Outcome in_json = hertzline({"run", "paper-wall", "-o", folder.file("a.wav"), "--set",
                                       "drive.amplitude_m=4e-6", "--columns", "v_last", "--json"});
    EXPECT_THAT(in_json.out, HasSubstr("beyond the full scale of 1")) << "among its warnings";
    const std::string quiet = run("b.wav", {"--wav-scale", "2", "-o", folder.file("b.csv")});
    EXPECT_THAT(quiet, testing::Not(HasSubstr("full scale")));
    EXPECT_EQ(column(folder.file("b.wav"), "v_last_m_per_s"),
              as_float32(column(folder.file("b.csv"), "v_last_m_per_s")));
    Program stream({"stream", "paper-wall", "--pace", "flat-out", "--duration", "5e-4", "--set",
                    "drive.amplitude_m=4e-6", "--wait-for-subscriber", "--bind", any_port, "--record",
                    folder.file("s.wav"), "--json"});
    const Outcome heard = hertzline({"listen", "--connect", stream.endpoint(), "--stream", "v_last", "-o",
                                     folder.file("l.wav"), "--wav-scale", "2"});
    EXPECT_THAT(heard.err, testing::Not(HasSubstr("full scale")));
    EXPECT_THAT(stream.wait().err, HasSubstr("s.wav: v_last_m_per_s reaches"));
    EXPECT_EQ(column(folder.file("l.wav"), "v_last_m_per_s"), column(folder.file("s.wav"), "v_last_m_per_s"));
}

}  // namespace

}  // namespace hertzline::test
