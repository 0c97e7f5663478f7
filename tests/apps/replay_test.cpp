// hertzline replay: a recording as if it were live.

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/recording_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;

namespace {

using nlohmann::json;
using testing::HasSubstr;

struct Replayed {
    json meta;
    Outcome replay;
    Outcome listener;
};

/// Replays a file flat out to a listener that is there from its first sample on.
Replayed replay(const std::string& file, const Words& listener_words, const Words& replay_words = {}) {
    Words words{"replay", file,     "--pace",           "flat-out", "--wait-for-subscriber",
                "--json", "--bind", "tcp://127.0.0.1:*"};
    words.insert(words.end(), replay_words.begin(), replay_words.end());
    Program program(words);
    Subscriber subscriber(program.endpoint());
    subscriber.subscribe("meta");
    Replayed replayed;
    replayed.meta = object_of(subscriber, "meta");
    Words listen{"listen", "--json", "--connect", program.endpoint()};
    listen.insert(listen.end(), listener_words.begin(), listener_words.end());
    replayed.listener = hertzline(listen);
    replayed.replay = program.wait();
    return replayed;
}

/// Records a run of 20 001 samples.
Outcome record(const Words& files) {
    Words words{"run", "paper-stream", "--json", "--set", "output.duration_s=2e-3", "--all"};
    for (const std::string& file : files) {
        words.insert(words.end(), {"-o", file});
    }
    const Outcome run = hertzline(words);
    EXPECT_EQ(run.status, 0) << run.err;
    return run;
}

class EachFormat : public testing::TestWithParam<const char*> {};

TEST_P(EachFormat, IsStreamedAgainSampleBySample) {
    const TemporaryFolder folder;
    const std::string file = folder.file(std::string("run") + GetParam());
    const std::string csv = folder.file("reference.csv");
    const Outcome run = record(file == csv ? Words{file} : Words{file, csv});
    const auto expected = csv_of(csv);
    for (const std::string stream : {"v_out", "v_chain"}) {
        const std::string heard_file = folder.file(stream + ".csv");
        const Replayed replayed = replay(file, {"--stream", stream, "-o", heard_file});
        ASSERT_EQ(replayed.replay.status, 0) << replayed.replay.err;
        ASSERT_EQ(replayed.listener.status, 0) << replayed.listener.err;
        EXPECT_EQ(replayed.meta["scene_hash"], run.json()["scene_hash"]);
        EXPECT_EQ(replayed.meta["replay"], file);
        EXPECT_EQ(replayed.listener.json()["samples"], 20'001);
        const std::string name = stream == "v_out" ? "v_out_m_per_s" : "v6_m_per_s";
        std::vector<double> as_streamed = expected.at(name);
        std::ranges::transform(as_streamed, as_streamed.begin(),
                               [](double v) { return static_cast<float>(v); });
        EXPECT_EQ(csv_of(heard_file).at(name), as_streamed);
    }
}

INSTANTIATE_TEST_SUITE_P(Replay, EachFormat,
                         testing::Values(".csv", ".sigmf-meta", ".sigmf-collection", ".npy", ".h5", ".wav"));

TEST(Replay, FramesAndIndicesAreThoseOfTheRunThatWasRecorded) {
    const TemporaryFolder folder;
    Program stream({"stream", "paper-wall", "--pace", "flat-out", "--duration", "1e-3", "--json", "--bind",
                    "tcp://127.0.0.1:*", "--record", folder.file("r.sigmf-meta"), "--set",
                    "output.frame_samples=300"});
    const json summary = stream.wait().json();
    const Replayed replayed = replay(folder.file("r.sigmf-meta"), {"--stream", "v_last"});
    EXPECT_EQ(replayed.meta["frame_samples"], 300);
    EXPECT_EQ(replayed.meta["recorded_run"], summary["run"]);
    EXPECT_NE(replayed.meta["run"], summary["run"]);
    EXPECT_EQ(replayed.replay.json()["samples"], 10'000);
    EXPECT_EQ(replayed.replay.json()["frames"], 34);
    EXPECT_EQ(replayed.listener.json()["first_sample"], 0);
}

TEST(Replay, WhatWasLostIsMissingAgainAndAListenerKnows) {
    const TemporaryFolder folder;
    const std::string file = folder.file("gap.sigmf-meta");
    const auto writer = open_recording(file, {.columns = {{"v_out_m_per_s", "v_out", "m/s"}},
                                              .sample_rate_hz = 1e6,
                                              .provenance = json::object()});
    const std::vector<double> values(1500, 0.25);
    writer->write(4000, values);
    writer->write(7000, values);
    writer->commit();
    const Replayed replayed = replay(file, {});
    EXPECT_EQ(replayed.replay.status, 0) << replayed.replay.err;
    EXPECT_EQ(replayed.listener.status, 1);
    const json account = replayed.listener.json();
    EXPECT_EQ(replayed.replay.json()["samples"], 4500);  // from the first on
    EXPECT_EQ(account["first_sample"], 4000);
    EXPECT_EQ(account["samples"], 3000);
    EXPECT_EQ(account["missing_samples"], 1500);
    EXPECT_EQ(account["frames_lost_on_the_way"], 0);
}

TEST(Replay, AFileWithoutARateNeedsOne) {
    const TemporaryFolder folder;
    // as numpy.save writes two float32 of its own: format 1.0, header padded to 128 bytes
    std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }";
    header.resize(117, ' ');
    std::string bytes = std::string("\x93NUMPY\x01") + '\0' + "\x76" + '\0' + header + '\n';
    bytes += std::string("\x00\x00\x80\x3f\x00\x00\x00\x40", 8);
    write_text(folder.file("own.npy"), bytes);
    const Outcome refused = hertzline({"replay", folder.file("own.npy")});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("--sample-rate"));
    const Replayed replayed = replay(folder.file("own.npy"), {}, {"--sample-rate", "1e6"});
    EXPECT_EQ(replayed.listener.status, 0) << replayed.listener.err;
    EXPECT_EQ(replayed.listener.json()["samples"], 2);
    EXPECT_EQ(replayed.listener.json()["fs"], 1e6);
}

TEST(Replay, SamplesOfARecordingThatBeginsLateAreThoseThatAreSent) {
    const TemporaryFolder folder;
    write_text(folder.file("l.csv"), "t_s,v_out_m_per_s\n300,1\n300.0000001,2\n300.0000002,3\n");
    const Replayed replayed = replay(folder.file("l.csv"), {});
    EXPECT_EQ(replayed.replay.json()["samples"], 3);
    EXPECT_EQ(replayed.listener.json()["samples"], 3);
    EXPECT_EQ(replayed.listener.json()["first_sample"], 3'000'000'000);
}

TEST(Replay, AGivenRateIsTheRateOfRoundedTimesToo) {
    const TemporaryFolder folder;
    std::string text = "t_s,v\n";
    for (int i = 0; i < 10'000; ++i) {
        text += fmt::format("{:.6f},1\n", i / 48'000.0);
    }
    write_text(folder.file("a.csv"), text);
    for (const Words& words : {Words{}, Words{"--sample-rate", "48000"}}) {
        const Replayed replayed = replay(folder.file("a.csv"), {}, words);
        EXPECT_EQ(replayed.listener.status, 0) << replayed.listener.err;
        EXPECT_EQ(replayed.listener.json()["fs"], 48'000);
        EXPECT_EQ(replayed.listener.json()["samples"], 10'000);
    }
}

TEST(Replay, ASingleRowAsksForItsRate) {
    const TemporaryFolder folder;
    write_text(folder.file("o.csv"), "t_s,v\n0,1\n");
    const Outcome outcome = hertzline({"replay", folder.file("o.csv")});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("has no sample rate: give --sample-rate"));
}

TEST(Replay, WarnsOfALastLineThatWasCut) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"), "t_s,v\n0,1\n1e-6,2\n2e-6,3");
    const Replayed replayed = replay(folder.file("a.csv"), {});
    EXPECT_EQ(replayed.replay.json()["samples"], 2);
    EXPECT_THAT(replayed.replay.err, HasSubstr("a.csv:4: left out"));
}

TEST(Replay, ARateBeyondAllRatesIsWrongUse) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"), "t_s,v_out_m_per_s\n0,1\n1,1\n");
    const Outcome outcome = hertzline({"replay", folder.file("a.csv"), "--sample-rate", "1e300"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--sample-rate: found 1e+300 Hz"));
}

TEST(Replay, AFileWithoutEndIsRefused) {
    const Outcome outcome = hertzline({"replay", "/dev/zero"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("/dev/zero:1: found a byte 0"));
}

TEST(Replay, WhatIsNoRecordingIsRefusedByName) {
    const TemporaryFolder folder;
    const Outcome unknown = hertzline({"replay", "burst.mp3"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_THAT(unknown.err, HasSubstr(".sigmf-meta"));
    const Outcome missing = hertzline({"replay", folder.file("none.csv")});
    EXPECT_EQ(missing.status, 1);
    EXPECT_THAT(missing.err, HasSubstr("none.csv"));
    write_text(folder.file("bad.csv"), "t_s,v_out_m_per_s\n0,one\n");
    const Outcome damaged = hertzline({"replay", folder.file("bad.csv"), "--sample-rate", "1e6"});
    EXPECT_EQ(damaged.status, 1);
    EXPECT_THAT(damaged.err, HasSubstr("bad.csv"));
}

TEST(Replay, AFileOnWhichTheLibraryCrashesIsRefusedByName) {
    const TemporaryFolder folder;
    const std::string file = folder.file("crash.h5");
    write_text(file, contents(HERTZLINE_SOURCE_DIR "/tests/fuzz/regressions/recording_hdf5/library_crashes"));
    const Outcome outcome = hertzline({"replay", file});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("cannot read " + file + ": "));
}

TEST(Replay, ATableIsNoRecordingAndIsCalledByItsName) {
    const TemporaryFolder folder;
    const auto refusal_of = [&](const std::string& name) {
        const Outcome outcome = hertzline({"replay", folder.file(name), "--sample-rate", "1e6"});
        EXPECT_EQ(outcome.status, 1) << name;
        EXPECT_EQ(outcome.out, "") << name;
        return outcome.err;
    };
    for (const std::string ending : {".csv", ".npy", ".h5"}) {
        ASSERT_EQ(hertzline({"run", "paper-wall", "--spectrum", folder.file("s" + ending)}).status, 0);
        EXPECT_THAT(refusal_of("s" + ending), HasSubstr("found a spectrum, allowed: a recording"));
    }
    for (const std::string ending : {".csv", ".h5"}) {
        ASSERT_EQ(
            hertzline({"sweep", "paper-wall", "--vary", "chain.spheres=5,6", "-o", folder.file("t" + ending)})
                .status,
            0);
        EXPECT_THAT(refusal_of("t" + ending),
                    HasSubstr("found a table of a sweep, a search or a field, allowed: a recording"));
    }
}

TEST(Replay, AFileNameNeedNotBeText) {
    const TemporaryFolder folder;
    const std::string file = folder.file("b\xfcrst.csv");  // Latin-1
    write_text(file, "t_s,v_out_m_per_s\n0,1\n1e-6,2\n2e-6,3\n");
    const Replayed replayed = replay(file, {}, {"--sample-rate", "1e6"});
    EXPECT_EQ(replayed.replay.status, 0) << replayed.replay.err;
    EXPECT_THAT(replayed.meta["replay"].get<std::string>(), testing::EndsWith("b\xef\xbf\xbdrst.csv"));
}

}  // namespace

}  // namespace hertzline::test
