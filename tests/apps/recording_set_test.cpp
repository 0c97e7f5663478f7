// Recordings as users make them: several at once, their failures, and the remains of failed ones.

#include <csignal>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/recording_formats.hpp"
#include "tests/apps/limit.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/recorded_columns.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

/// Returns v_out of `count` samples of paper-stream, by `run`.
std::vector<double> v_out_of_run(std::size_t count, const TemporaryFolder& folder) {
    const std::string duration = fmt::format("{}", static_cast<double>(count) / 10e6);
    const Outcome run = hertzline({"run", "paper-stream", "--set", "output.duration_s=" + duration, "-o",
                                   folder.file("reference.npy")});
    EXPECT_EQ(run.status, 0) << run.err;
    std::vector<double> values = column(folder.file("reference.npy"), "v_out_m_per_s");
    EXPECT_GE(values.size(), count);
    values.resize(count);
    return values;
}

TEST(RecordingSet, AllOfARunOfAStreamAndOfAListenerHoldTheSameSamples) {
    const TemporaryFolder folder;
    Words stream_words{"stream", "paper-stream",          "--pace", "flat-out", "--duration", "2e-3",
                       "--json", "--wait-for-subscriber", "--bind", any_port};
    for (const char* file : {"s.csv", "s.sigmf-meta", "s.npy"}) {
        stream_words.insert(stream_words.end(), {"--record", folder.file(file)});
    }
    Program stream(stream_words);
    const Outcome heard = hertzline({"listen", "--connect", stream.endpoint(), "--json", "-o",
                                     folder.file("l.sigmf-data"), "-o", folder.file("l.csv")});
    const Outcome streamed = stream.wait();
    ASSERT_EQ(streamed.status, 0) << streamed.err;
    ASSERT_EQ(heard.status, 0) << heard.err;
    const json summary = streamed.json();
    for (const json& one : summary["recordings"]) {
        EXPECT_EQ(one["status"], "complete");
        EXPECT_EQ(one["samples"], 20'000);
    }
    const std::vector<double> run = v_out_of_run(20'000, folder);
    for (const char* file : {"s.csv", "s.npy"}) {
        EXPECT_EQ(column(folder.file(file), "v_out_m_per_s"), run) << file;
    }
    for (const char* file : {"s.sigmf-meta", "l.sigmf-meta", "l.csv"}) {
        EXPECT_EQ(column(folder.file(file), "v_out_m_per_s"), as_float32(run)) << file;
    }
}

TEST(RecordingSet, EachSaysWhereItComesFrom) {
    const TemporaryFolder folder;
    Program stream({"stream", "paper-stream", "--pace", "flat-out", "--duration", "1e-3", "--json",
                    "--wait-for-subscriber", "--bind", any_port, "--record", folder.file("s.sigmf-meta")});
    Subscriber subscriber(stream.endpoint());
    subscriber.subscribe("meta");
    const json meta = object_of(subscriber, "meta");
    hertzline({"listen", "--connect", stream.endpoint(), "-o", folder.file("l.csv")});
    const std::string hash = stream.wait().json()["scene_hash"];
    for (const char* file : {"s.sigmf-meta", "l.csv"}) {
        const json provenance = open_reader(folder.file(file))->head().provenance;
        for (const char* key :
             {"program", "version", "git_hash", "compiler", "simd_target", "start_time", "run", "scene_hash",
              "integrator", "step_s", "estimated_error", "estimated_over_s", "scene"}) {
            EXPECT_TRUE(provenance.contains(key)) << file << " " << key;
            EXPECT_EQ(provenance.value(key, json()), meta.value(key, json())) << file << " " << key;
        }
        EXPECT_EQ(provenance["scene_hash"], hash);
        EXPECT_EQ(provenance["version"], HERTZLINE_VERSION);
    }
}

TEST(RecordingSet, NoneHasAFileOfAnother) {
    const TemporaryFolder folder;
    const std::string collection = folder.file("a.sigmf-collection");
    const std::string member = folder.file("a-v_out_m_per_s.sigmf-meta");
    const auto fault = [](const Words& words) {
        const Outcome outcome = hertzline(words);
        EXPECT_EQ(outcome.status, 2) << testing::PrintToString(words);
        return outcome.err;
    };
    EXPECT_THAT(fault({"run", "paper-wall", "-o", collection, "-o", member}),
                HasSubstr("found files of " + collection));
    EXPECT_THAT(fault({"stream", "paper-wall", "--record", member, "--record", collection}),
                HasSubstr("found files of " + member));
    ASSERT_EQ(hertzline({"run", "paper-wall", "-o", collection}).status, 0);
    EXPECT_THAT(fault({"run", collection, "-o", member}), HasSubstr("found a file that is read here"));
    EXPECT_THAT(fault({"run", "paper-wall", "--set", "drive.kind=file", "--set",
                       "drive.file=" + folder.file("a-v_out_m_per_s.sigmf-data"), "-o", collection}),
                HasSubstr("found a file that is read here"));
    EXPECT_EQ(
        hertzline({"run", "paper-wall", "-o", collection, "-o", folder.file("b-v_out.sigmf-meta")}).status,
        0);
}

TEST(RecordingSet, OneThatCannotBeBegunIsAnErrorBeforeAnythingIsStreamed) {
    const TemporaryFolder folder;
    const Outcome stream = hertzline({"stream", "paper-stream", "--bind", any_port, "--record",
                                      folder.file("a.csv"), "--record", folder.file("none/b.csv")});
    EXPECT_EQ(stream.status, 1);
    EXPECT_THAT(stream.err, AllOf(HasSubstr("none/b.csv"), HasSubstr("No such file or directory"),
                                  testing::Not(HasSubstr("endpoint"))));
    EXPECT_TRUE(fs::is_empty(fs::path(folder.file("a.csv")).parent_path()));
}

TEST(RecordingSet, AFullDiskEndsOneOfARunsFilesAndNotTheOthers) {
    const TemporaryFolder folder;
    const Outcome outcome =
        hertzline({"run", "paper-wall", "--json", "-o", "/dev/full", "-o", folder.file("a.csv")});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
    EXPECT_THAT(outcome.json()["recordings"][0]["status"].get<std::string>(), HasSubstr("No space left"));
    EXPECT_EQ(outcome.json()["recordings"][1]["status"], "complete");
    EXPECT_EQ(csv_of(folder.file("a.csv")).at("t_s").size(), 5001U);
}

/// Returns the file that a failed recording's status names.
std::string kept_file(const json& recording) {
    const std::string status = recording["status"];
    const std::string before = fmt::format("{} samples are in ", recording["samples"].get<int>());
    const std::size_t at = status.find(before);
    return at == std::string::npos ? "" : status.substr(at + before.size());
}

/// Returns the number of lines of a CSV, without its first.
std::int64_t rows_of(const std::string& csv) {
    const std::string text = contents(csv);
    return std::count(text.begin(), text.end(), '\n') - 1;
}

TEST(RecordingSet, ARunWhoseOnlyFileFailsLeavesTheOldOneAloneAndWhatItHas) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"), "old");
    const Limit limit(RLIMIT_FSIZE, 50'000);
    const Outcome outcome = hertzline({"run", "paper-wall", "-o", folder.file("a.csv")});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("a.csv"), HasSubstr("File too large")));
    EXPECT_EQ(contents(folder.file("a.csv")), "old");
    EXPECT_FALSE(fs::exists(folder.file("a.csv-metadata.json")));
    std::smatch kept;
    ASSERT_TRUE(std::regex_search(outcome.err, kept, std::regex("(\\d+) samples are in (\\S+)")));
    EXPECT_GT(rows_of(kept[2]), 100);
    EXPECT_EQ(rows_of(kept[2]), std::stoi(kept[1]));
}

TEST(RecordingSet, ADiskTooFullForMetadataLeavesTheOldFileAlone) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"), "old");
    const Limit limit(RLIMIT_FSIZE, 1500);  // more than the CSV of eleven rows
    const Outcome outcome =
        hertzline({"run", "paper-wall", "--set", "output.duration_s=1e-6", "-o", folder.file("a.csv")});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("a.csv-metadata.json: File too large"));
    EXPECT_EQ(contents(folder.file("a.csv")), "old");
}

TEST(RecordingSet, TheStreamGoesOnWhenTheDiskIsFull) {
    const TemporaryFolder folder;
    constexpr rlim_t limit = 1 << 20;
    std::unique_ptr<Program> stream;
    {
        const Limit small(RLIMIT_FSIZE, limit);
        stream = std::make_unique<Program>(
            Words{"stream", "paper-stream", "--pace", "flat-out", "--duration", "0.03", "--json",
                  "--wait-for-subscriber", "--record", folder.file("a.sigmf-meta"), "--record",
                  folder.file("a.csv"), "--record", "/dev/null", "--bind", any_port});
    }
    const Outcome heard = hertzline({"listen", "--connect", stream->endpoint(), "--json"});
    const Outcome streamed = stream->wait();
    EXPECT_EQ(heard.json()["samples"], 300'000);
    EXPECT_EQ(heard.json()["gapless"], true);
    EXPECT_EQ(streamed.status, 1);
    EXPECT_THAT(streamed.err, AllOf(HasSubstr("recording " + folder.file("a.sigmf-meta") + " ended after"),
                                    HasSubstr("File too large; the stream continues")));
    const json recordings = streamed.json()["recordings"];
    EXPECT_THAT(recordings[0]["status"].get<std::string>(), HasSubstr("File too large"));
    EXPECT_THAT(recordings[1]["status"].get<std::string>(), HasSubstr("File too large"));
    EXPECT_EQ(recordings[2]["status"], "complete");
    EXPECT_EQ(recordings[2]["samples"], 300'000);
    EXPECT_FALSE(fs::exists(folder.file("a.csv")));
    // the samples that fitted on the disk are there
    EXPECT_GT(recordings[1]["samples"], 5000);
    EXPECT_EQ(rows_of(kept_file(recordings[1])), recordings[1]["samples"]);
    EXPECT_EQ(recordings[0]["samples"], limit / 12);
    const std::vector<double> kept = column(folder.file("a.sigmf-meta"), "v_out_m_per_s");
    EXPECT_EQ(kept.size(), limit / 12);
    EXPECT_EQ(kept, as_float32(v_out_of_run(kept.size(), folder)));
}

TEST(RecordingSet, TheStreamGoesOnWhenTheFileVanishes) {
    const TemporaryFolder folder;
    Program stream(
        {"stream", "paper-stream", "--json", "--record", folder.file("a.sigmf-meta"), "--bind", any_port});
    ASSERT_TRUE(eventually([&] { return fs::exists(folder.file("a.sigmf-meta")); }));
    fs::remove(folder.file("a.sigmf-data"));
    stream.messages_with("the stream continues");
    Subscriber subscriber(stream.endpoint());
    subscriber.subscribe("v_out/raw");
    EXPECT_NE(subscriber.receive(std::chrono::seconds(60)), nullptr);
    stream.send(SIGINT);
    const Outcome outcome = stream.wait();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("No such file"));
}

TEST(RecordingSet, AKilledStreamLeavesAllButTheLastSecond) {
    const TemporaryFolder folder;
    Program stream({"stream", "paper-stream", "--record", folder.file("a.sigmf-meta"), "--record",
                    folder.file("a.csv"), "--bind", any_port, "--pace", "0.01"});
    Subscriber subscriber(stream.endpoint());
    subscriber.subscribe("v_out/np");
    std::int64_t sent = 0;
    while (sent < 200'000) {  // 20 ms of the run, two seconds of ours
        const Message* message = subscriber.receive(std::chrono::seconds(60));
        ASSERT_NE(message, nullptr);
        const json header = json::parse(message->text(0));
        sent = header["sample"].get<std::int64_t>() + header["shape"][0].get<std::int64_t>();
    }
    stream.send(SIGKILL);
    stream.wait();
    const std::vector<double> kept = column(folder.file("a.sigmf-meta"), "v_out_m_per_s");
    const auto a_second = static_cast<std::size_t>(0.01 * 10e6);
    EXPECT_GT(kept.size() + a_second, static_cast<std::size_t>(sent));
    EXPECT_EQ(kept, as_float32(v_out_of_run(kept.size(), folder)));
    EXPECT_FALSE(fs::exists(folder.file("a.csv"))) << "half a CSV under its name";
}

TEST(RecordingSet, AnInterruptedRunLeavesNoneOfThem) {
    const TemporaryFolder folder;
    Program run({"run", "paper-stream", "-o", folder.file("a.sigmf-meta"), "-o", folder.file("a.csv"),
                 "--set", "output.duration_s=1.2"});
    ASSERT_TRUE(eventually([&] { return !fs::is_empty(fs::path(folder.file("x")).parent_path()); }));
    run.send(SIGINT);
    EXPECT_EQ(run.wait().status, 1);
    EXPECT_TRUE(fs::is_empty(fs::path(folder.file("x")).parent_path()));
}

TEST(RecordingSet, AnInterruptedRunLeavesAnOldRecordingAsItWas) {
    const TemporaryFolder folder;
    write_text(folder.file("a.sigmf-meta"), "old");
    write_text(folder.file("a.sigmf-data"), "old");
    Program run({"run", "paper-stream", "-o", folder.file("a.sigmf-meta"), "--set", "output.duration_s=5"});
    const auto has_written = [&] {
        return std::ranges::any_of(fs::directory_iterator(fs::path(folder.file("x")).parent_path()),
                                   [](const fs::directory_entry& entry) {
                                       std::error_code gone;
                                       const auto size = entry.file_size(gone);
                                       return !gone && size > 3;
                                   });
    };
    ASSERT_TRUE(eventually(has_written));
    run.send(SIGINT);
    EXPECT_EQ(run.wait().status, 1);
    EXPECT_EQ(contents(folder.file("a.sigmf-meta")) + contents(folder.file("a.sigmf-data")), "oldold");
}

/// A scene whose step turns out to be too long after some milliseconds. The motion is chaotic, so the moment depends on the instruction
/// set, and the scene lasts much longer.
const Words unstable{"--set", "numerics.integrator=leapfrog", "--set", "numerics.step_s=2.3e-7",
                     "--set", "drive.amplitude_m=1.05e-3",    "--set", "output.duration_s=0.5"};

TEST(RecordingSet, ARunThatFailsKeepsWhatItHasUnderAnotherName) {
    const TemporaryFolder folder;
    Words words{"run", "paper-stream", "-o", folder.file("a.csv"), "-o", folder.file("a.sigmf-data")};
    words.insert(words.end(), unstable.begin(), unstable.end());
    const Outcome run = hertzline(words);
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.err, HasSubstr("stability limit"));
    EXPECT_FALSE(fs::exists(folder.file("a.csv")));
    EXPECT_FALSE(fs::exists(folder.file("a.sigmf-data")));
    std::smatch kept;
    ASSERT_TRUE(std::regex_search(run.err, kept, std::regex("(\\d+) samples are in (\\S+csv\\S+)")));
    EXPECT_GT(rows_of(kept[2]), 20'000);
    EXPECT_EQ(rows_of(kept[2]), std::stoi(kept[1]));
}

TEST(RecordingSet, AStreamThatFailsSavesWhatItSent) {
    const TemporaryFolder folder;
    Words words{"stream",   "paper-stream",
                "--pace",   "flat-out",
                "--bind",   any_port,
                "--record", folder.file("a.csv"),
                "--record", folder.file("a.sigmf-data")};
    words.insert(words.end(), unstable.begin(), unstable.end());
    const Outcome stream = hertzline(words);
    EXPECT_EQ(stream.status, 1);
    EXPECT_GT(rows_of(folder.file("a.csv")), 20'000);
    EXPECT_EQ(fs::file_size(folder.file("a.sigmf-data")),
              static_cast<std::uintmax_t>(rows_of(folder.file("a.csv"))) * 12);
}

TEST(RecordingSet, AListenerWhoseDiskIsFullHearsTheRest) {
    const TemporaryFolder folder;
    Program stream({"stream", "paper-stream", "--pace", "flat-out", "--duration", "5e-3", "--json",
                    "--wait-for-subscriber", "--bind", any_port});
    const std::string endpoint = stream.endpoint();
    const Outcome heard =
        hertzline({"listen", "--connect", endpoint, "--json", "-o", "/dev/full", "-o", folder.file("l.csv")});
    EXPECT_EQ(heard.status, 1);
    EXPECT_EQ(heard.json()["gapless"], true);
    EXPECT_EQ(heard.json()["samples"], 50'000);
    EXPECT_THAT(heard.json()["recordings"][0]["status"].get<std::string>(), HasSubstr("No space left"));
    EXPECT_EQ(heard.json()["recordings"][1]["status"], "complete");
    EXPECT_EQ(stream.wait().status, 0);
}

}  // namespace

}  // namespace hertzline::test
