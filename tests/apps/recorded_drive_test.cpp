// A horn that moves as a record does, by the commands: formats, recordings that need no other file, sweeps, pictures.

#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RecordedDrive : public ::testing::Test {
protected:
    RecordedDrive() {
        hertzline({"run", "paper-wall", "-o", horn_, "--columns", "v_horn", "--set", "drive.cycles=8"});
    }

    Words driven(const Words& words) const {
        Words all{"run",   "paper-vitreous-carbon", "--set", "drive.kind=file",
                  "--set", "drive.file=" + horn_,   "--set", "output.duration_s=2e-4"};
        all.insert(all.end(), words.begin(), words.end());
        return all;
    }

    TemporaryFolder folder_;
    std::string horn_ = folder_.file("h\u00f6rn \u6ce2.csv");
};

TEST_F(RecordedDrive, ARecordingNeedsNoOtherFile) {
    for (const char* name : {"a.csv", "a.npy", "a.h5", "a.sigmf-meta"}) {
        const Outcome run = hertzline(driven({"-o", folder_.file(name), "--columns", "v_last"}));
        ASSERT_EQ(run.status, 0) << run.err;
    }
    std::filesystem::remove(horn_);
    for (const char* name : {"a.csv", "a.npy", "a.h5", "a.sigmf-meta"}) {
        const Outcome again =
            hertzline({"run", folder_.file(name), "-o", folder_.file("again.csv"), "--columns", "v_last"});
        ASSERT_EQ(again.status, 0) << again.err;
        EXPECT_EQ(contents(folder_.file("again.csv")), contents(folder_.file("a.csv"))) << name;
    }
}

TEST_F(RecordedDrive, ARecordingIsASceneToo) {
    ASSERT_EQ(hertzline(driven({"-o", folder_.file("a.h5")})).status, 0);
    const Outcome text = hertzline({"scenes", folder_.file("a.h5")});
    ASSERT_EQ(text.status, 0) << text.err;
    write_text(folder_.file("again.toml"), text.out);
    const json first = json::parse(hertzline({"check", folder_.file("a.h5"), "--json"}).out);
    const json again = json::parse(hertzline({"check", folder_.file("again.toml"), "--json"}).out);
    EXPECT_EQ(first["scene_hash"], again["scene_hash"]);
    const Outcome rows = hertzline({"sweep", folder_.file("a.h5"), "--vary", "drive.scale=0.5,1", "--json",
                                    "--quantity", "peak_v_last_m_per_s"});
    EXPECT_EQ(rows.status, 0) << rows.err;
    write_text(folder_.file("other.csv"), "t_s,v\n0,1\n1,2\n");
    EXPECT_THAT(hertzline({"check", folder_.file("other.csv")}).err,
                HasSubstr("no scene in this recording, allowed: scenes, and recordings of hertzline"));
}

TEST_F(RecordedDrive, CheckTellsTheRecord) {
    Words words = driven({"--json"});
    words[0] = "check";
    const json report = json::parse(hertzline(words).out);
    EXPECT_EQ(report["record_samples"], 5001);
    EXPECT_EQ(report["record_quantity"], "velocity");
    EXPECT_NEAR(report["record_frequency_hz"].get<double>(), 73e3, 2e3);
    EXPECT_NEAR(report["record_velocity_m_per_s"].get<double>(), 1.37, 0.02);
    for (const char* name :
         {"record_sample_rate_hz", "record_lowpass_hz", "record_beyond_ratio", "record_noise_m_per_s",
          "record_noise_velocity_m_per_s", "record_offset_m_per_s", "record_drift_m_per_s"}) {
        EXPECT_TRUE(report[name].is_number()) << name;
    }
    EXPECT_EQ(report["record_drift_removed"], false);
}

TEST_F(RecordedDrive, FilesVaryInASweep) {
    const std::string other = folder_.file("other.csv");
    hertzline({"run", "paper-wall", "-o", other, "--columns", "v_horn", "--set", "drive.amplitude_m=1e-6"});
    const Words sweep{
        "sweep",      "paper-wall",          "--vary", "drive.file=" + horn_ + "," + other + ",none.csv",
        "--quantity", "peak_v_last_m_per_s", "--json", "--set"};
    Words words = sweep;
    words.emplace_back("drive.kind=file");
    const Outcome outcome = hertzline(words);
    std::vector<json> rows;
    for (std::istringstream lines(outcome.out); lines;) {
        std::string line;
        if (std::getline(lines, line)) {
            rows.push_back(json::parse(line));
        }
    }
    ASSERT_EQ(rows.size(), 3U) << outcome.err;
    EXPECT_GT(rows[0]["peak_v_last_m_per_s"].get<double>(),
              1.2 * rows[1]["peak_v_last_m_per_s"].get<double>());
    EXPECT_EQ(rows[2]["status"], "refused");
    EXPECT_THAT(rows[2]["message"].get<std::string>(), HasSubstr("\"none.csv\", which is no file"));
    words.insert(words.end(), {"--set", "drive.file=" + horn_});
    EXPECT_THAT(hertzline(words).err, HasSubstr("found a key that varies"));
}

TEST_F(RecordedDrive, NoCommandPutsItsOutputInTheRecordsPlace) {
    const std::string before = contents(horn_);
    const std::string file = "drive.file=" + horn_;
    const Words wall{"paper-wall", "--set", "drive.kind=file"};
    const Words set{"--set", file};
    const Words vary{
        "--vary", "chain.preload_n=0.1..0.2", "--maximise", "peak_v_out_m_per_s", "--evaluations", "2"};
    const Words field{"wet-vitreous-carbon", "--set", "drive.kind=file", "--plane", "z=1mm"};
    for (const auto& [command, words] : {
             std::pair<std::string, Words>{"run", with(wall, with(set, {"-o", horn_}))},
             {"run", with(wall, with(set, {"--spectrum", horn_}))},
             {"sweep", with(wall, with(set, {"--vary", "chain.preload_n=0.1,0.2", "-o", horn_}))},
             {"sweep", with(wall, {"--vary", file, "-o", horn_})},
             {"optimise", with(wall, with(set, with(vary, {"-o", horn_})))},
             {"field", with(field, with(set, {"-o", horn_}))},
             {"stream", with(wall, with(set, {"--record", horn_}))},
         }) {
        const Outcome outcome = hertzline(with({command}, words));
        EXPECT_EQ(outcome.status, 2) << command;
        EXPECT_THAT(outcome.err, HasSubstr("found a file that is read here")) << command;
    }
    ASSERT_EQ(hertzline(driven({"-o", folder_.file("a.h5")})).status, 0);
    EXPECT_THAT(hertzline({"run", folder_.file("a.h5"), "-o", folder_.file("a.h5")}).err,
                HasSubstr("found a file that is read here"));
    EXPECT_EQ(contents(horn_), before);
    const std::string folder = folder_.file(std::string(140, 'x'));
    std::filesystem::create_directory(folder);
    std::filesystem::copy_file(horn_, folder + "/horn.csv");
    write_text(folder + "/s.toml", "[drive]\nkind = \"file\"\nfile = \"horn.csv\"\n");
    EXPECT_THAT(hertzline({"run", folder + "/s.toml", "-o", folder + "/horn.csv"}).err,
                HasSubstr("found a file that is read here"));
}

TEST_F(RecordedDrive, PartsOfASweepHaveTheSameFiles) {
    const std::string table = folder_.file("s.csv");
    const Words sweep{"sweep",      "paper-wall",          "--set",  "drive.kind=file",
                      "--vary",     "drive.file=" + horn_, "--vary", "chain.preload_n=0.1,0.2",
                      "--quantity", "peak_v_out_m_per_s",  "-o",     table};
    ASSERT_EQ(hertzline(with(sweep, {"--shard", "1/2"})).status, 0);
    hertzline({"run", "paper-wall", "-o", horn_, "--columns", "v_horn", "--set", "drive.cycles=5"});
    ASSERT_EQ(hertzline(with(sweep, {"--shard", "2/2"})).status, 0);
    const Outcome merged =
        hertzline({"sweep", "--merge", table + ".1-of-2.journal", table + ".2-of-2.journal", "-o", table});
    EXPECT_NE(merged.status, 0);
    EXPECT_THAT(merged.err, HasSubstr("content of drive.file"));
    EXPECT_THAT(hertzline(with(sweep, {"--shard", "1/2", "--resume"})).err,
                HasSubstr("content of drive.file"));
}

TEST_F(RecordedDrive, MetadataBelongToTheContentOfASweptFile) {
    const std::string meta = folder_.file("tip.sigmf-meta");
    ASSERT_EQ(hertzline({"run", "paper-wall", "-o", meta, "--columns", "v_horn"}).status, 0);
    const Words sweep{"sweep",   "paper-wall",
                      "--set",   "drive.kind=file",
                      "--vary",  "drive.file=" + folder_.file("tip.sigmf-data"),
                      "--vary",  "chain.preload_n=0.1,0.2",
                      "-o",      folder_.file("s.csv"),
                      "--shard", "1/2"};
    ASSERT_EQ(hertzline(sweep).status, 0);
    json changed = json::parse(contents(meta));
    changed["global"]["core:sample_rate"] = 5e6;
    write_text(meta, changed.dump());
    EXPECT_THAT(hertzline(with(sweep, {"--resume"})).err, HasSubstr("content of drive.file"));
}

TEST_F(RecordedDrive, KeysByWhichARecordIsReadVaryWithItsFile) {
    const Words fixed{"sweep", "paper-wall",          "--set", "drive.kind=file",
                      "--set", "drive.file=" + horn_, "--json"};
    for (const char* axis :
         {"drive.sample_rate_hz=5e6,1e7", "drive.quantity=displacement", "drive.column=1"}) {
        const Outcome outcome = hertzline(with(fixed, {"--vary", axis}));
        EXPECT_EQ(outcome.status, 2) << axis;
        EXPECT_THAT(outcome.err, HasSubstr("allowed: such a key beside --vary drive.file=FILE")) << axis;
    }
    const Words rate{"--set", "drive.sample_rate_hz=5e6"};
    const json run = json::parse(hertzline(driven(with(rate, {"--json"}))).out);
    const Outcome rows =
        hertzline({"sweep", "paper-vitreous-carbon", "--set", "drive.kind=file", "--set",
                   "output.duration_s=2e-4", "--vary", "drive.file=" + horn_, "--vary",
                   "drive.sample_rate_hz=5e6,1e7", "--quantity", "fundamental_hz,thd_r", "--json"});
    ASSERT_EQ(rows.status, 0) << rows.err;
    const json row = json::parse(rows.out.substr(0, rows.out.find('\n')));
    EXPECT_NEAR(row["fundamental_hz"].get<double>(), 36.5e3, 1e3);
    EXPECT_EQ(row["fundamental_hz"], run["fundamental_hz"]);
    EXPECT_THAT(row["message"].get<std::string>(), HasSubstr("drive.sample_rate_hz = 5e+06 takes its place"));
}

TEST_F(RecordedDrive, ASweepCountsHarmonicsFromTheFrequencyThatRunDoes) {
    const std::string device = folder_.file("device.toml");
    write_text(device, "[drive]\nfrequency_hz = 50e3\n[end]\nkind = 'wall'\n[output]\nduration_s = 2e-4\n");
    for (const char* given : {"drive.start_s=0", "drive.frequency_hz=73000"}) {  // the default, too
        const Words scene{device, "--set", "drive.kind=file", "--set", given, "--json"};
        const json run = hertzline(with(with({"run"}, scene), {"--set", "drive.file=" + horn_})).json();
        const json row = hertzline(with(with({"sweep"}, scene),
                                        {"--vary", "drive.file=" + horn_, "--quantity", "fundamental_hz"}))
                             .json();
        EXPECT_NEAR(run["fundamental_hz"].get<double>(), 73e3, 2e3);
        EXPECT_EQ(row["fundamental_hz"], run["fundamental_hz"]) << given;
    }
}

TEST_F(RecordedDrive, WarningsTellWhatIsOdd) {
    const Outcome cut = hertzline(driven({"--set", "drive.lowpass_hz=60e3"}));
    EXPECT_EQ(cut.status, 2);
    EXPECT_THAT(cut.err,
                HasSubstr("drive.lowpass_hz: found 60000, with which the motion begins before the record"));
    const Outcome less =
        hertzline(driven({"--set", "drive.lowpass_hz=40e3", "--set", "drive.repetition_hz=0"}));
    EXPECT_EQ(less.status, 2);
    EXPECT_THAT(hertzline(driven({"--set", "drive.scale=1e3"})).err,
                AllOf(HasSubstr("the drive's record is 0.00"),
                      HasSubstr("were micrometres (drive.scale), or a velocity")));
    const Outcome good = hertzline(driven({}));
    EXPECT_THAT(good.err, Not(HasSubstr("drive."))) << good.err;
}

TEST_F(RecordedDrive, APictureOfTheHornShowsTheRecordsSamples) {
    hertzline(driven({"-o", folder_.file("a.npy"), "--columns", "v_horn,v_last"}));
    const Outcome drawn = hertzline({"plot", folder_.file("a.npy"), "-o", folder_.file("a.svg")});
    ASSERT_EQ(drawn.status, 0) << drawn.err;
    const std::string svg = contents(folder_.file("a.svg"));
    std::size_t dots = 0;
    for (std::size_t at = svg.find("<use "); at != std::string::npos; at = svg.find("<use ", at + 1)) {
        ++dots;
    }
    EXPECT_GT(dots, 1900U);
}

}  // namespace
}  // namespace hertzline::test
