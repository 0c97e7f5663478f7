// hertzline listen against streams that are interrupted, flooded, wrong or hostile.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <regex>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/recording_formats.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/publisher.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;

namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A stream that sends messages made by a test to one listener.
class FakeStream {
public:
    /// @param timeout_s empty: the program's own
    explicit FakeStream(const std::string& timeout_s = "100", const std::vector<std::string>& words = {},
                        const std::string& name = "v_out")
        : publisher_(any_port), listener_(command(timeout_s, words)), topic(name + "/np") {
        frame_.stream = name;
        frame_.run = "run-1";
        frame_.fs = 1e6;
        frame_.n = 10;
        for (int tries = 0; tries < 6000 && !publisher_.wanted(topic); ++tries) {
            if (publisher_.poll_subscriptions() > 0) {
                send_text("meta", json{{"streams", {{{"name", name}}}}}.dump());
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        EXPECT_TRUE(publisher_.wanted(topic)) << "no listener";
    }

    /// Sends a frame of ten samples.
    void send(std::uint64_t seq, std::uint64_t sample, std::uint64_t dropped = 0, float value = 0) {
        frame_.seq = seq;
        frame_.sample = sample;
        frame_.dropped = dropped;
        std::string header;
        encode_header(frame_, header);
        const std::vector<float> values(frame_.n * frame_.channels, value);
        send_text(topic, header,
                  std::string(reinterpret_cast<const char*>(values.data()), frame_.payload_bytes()));
    }
    void reshape(std::size_t samples, std::size_t channels) {
        frame_.n = samples;
        frame_.channels = channels;
    }
    const Program& listener() const { return listener_; }
    void begin_another_run() { frame_.run = "run-2"; }
    template <class... Parts>
    void send_text(std::string_view to, const Parts&... parts) {
        EXPECT_TRUE(publisher_.send(to, std::string_view(parts)...));
    }
    Outcome end(std::int64_t samples, std::int64_t dropped_frames = 0) {
        send_text(
            "end",
            json{{"run", frame_.run}, {"samples", samples}, {frame_.stream + "_np_dropped", dropped_frames}}
                .dump());
        return fall_silent();
    }
    Outcome fall_silent() { return listener_.wait(); }

private:
    Words command(const std::string& timeout_s, const Words& more) const {
        Words words{"listen", "--json", "--connect", publisher_.endpoint()};
        if (!timeout_s.empty()) {
            words.insert(words.end(), {"--timeout", timeout_s});
        }
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }

    Publisher publisher_;
    Program listener_;
    FrameHeader frame_;

public:
    const std::string topic;
};

/// Expects that the listener ended with this status and this account.
void expect_account(const Outcome& outcome, int status, const json& expected) {
    EXPECT_EQ(outcome.status, status) << outcome.err;
    const json account = outcome.json();
    for (const auto& [name, value] : expected.items()) {
        EXPECT_EQ(account.at(name), value) << name;
    }
}

TEST(Listen, CountsAreOfAtLeastOne) {
    for (const char* samples : {"0", "-3", "-9223372036854775808"}) {
        const Outcome outcome = hertzline({"listen", "--samples", samples, "--timeout", "0.1"});
        EXPECT_EQ(outcome.status, 2) << samples;
        EXPECT_THAT(outcome.err, HasSubstr("--samples: found")) << samples;
    }
    const Outcome memory = hertzline({"stream", "paper-wall", "--queue-memory", "-1"});
    EXPECT_EQ(memory.status, 2);
    EXPECT_THAT(memory.err, HasSubstr("--queue-memory: found -1"));
}

TEST(Listen, JoiningLateIsNoGap) {
    FakeStream stream;
    stream.send(5, 50);
    stream.send(6, 60);
    const Outcome outcome = stream.end(70);
    expect_account(outcome, 0, {{"first_sample", 50}, {"samples", 20}});
    EXPECT_THAT(outcome.err, HasSubstr("joined run run-1 at sample 50"));
}

TEST(Listen, NamesTheSideThatLostSamples) {
    FakeStream stream;
    stream.send(0, 0);
    stream.send(2, 20, 1);
    stream.send(4, 40, 1);
    const Outcome outcome = stream.end(50);
    expect_account(outcome, 1,
                   {{"frames_dropped_by_sender", 1}, {"frames_lost_on_the_way", 1}, {"missing_samples", 20}});
    EXPECT_THAT(outcome.err,
                HasSubstr("10 samples are missing before sample 20: 1 frames dropped by the sender, 0 lost"));
}

TEST(Listen, TheEndCountsSamplesThatNeverCame) {
    FakeStream stream;
    stream.send(0, 0);
    expect_account(stream.end(30), 1, {{"missing_samples", 20}, {"ended_by", "end of run"}});
}

TEST(Listen, TheEndCountsFramesThatTheSenderDroppedLast) {
    FakeStream stream;
    stream.send(0, 0);
    stream.send(3, 30, 2);
    const Outcome outcome = stream.end(40, 7);
    expect_account(outcome, 1,
                   {{"frames_dropped_by_sender", 7}, {"frames_lost_on_the_way", 0}, {"gapless", false}});
    EXPECT_THAT(outcome.err, HasSubstr("5 frames were dropped by the sender before the end"));
}

TEST(Listen, AStreamThatFallsSilentWasNotHeardToItsEnd) {
    FakeStream stream("2");
    stream.send(0, 0);
    const Outcome outcome = stream.fall_silent();
    expect_account(outcome, 1, {{"samples", 10}, {"gapless", false}});
    EXPECT_THAT(outcome.err, HasSubstr("nothing arrived for 2 s"));
}

TEST(Listen, WaitsFifteenSecondsForAStreamThatWasReceived) {
    FakeStream stream("");
    stream.send(0, 0);
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = stream.fall_silent();
    EXPECT_GT(std::chrono::steady_clock::now() - start, std::chrono::seconds(14));
    EXPECT_THAT(outcome.err, HasSubstr("nothing arrived for 15 s"));
}

TEST(Listen, RepeatedAndLateFramesAreNotKept) {
    FakeStream stream;
    stream.send(3, 30);
    stream.send(3, 30);
    stream.send(1, 10);
    expect_account(stream.end(40), 1, {{"samples", 10}, {"frames_repeated", 1}, {"frames_out_of_order", 1}});
}

TEST(Listen, AnOddFrameCostsNothingThatWasRecorded) {
    for (const char* name : {"a.sigmf-meta", "a.sigmf-collection", "a.csv", "a.npy", "a.h5", "a.wav"}) {
        const TemporaryFolder folder;
        FakeStream stream("100", {"-o", folder.file(name)});
        std::uint64_t seq = 0;
        for (; seq < 1000; ++seq) {
            stream.send(seq, 10 * seq);
        }
        stream.send(seq, 0);       // goes back
        stream.send(seq + 1, 10);  // and on from there
        stream.send(seq + 2, 10 * seq + 20, 0, NAN);
        stream.send(seq + 3, 10 * seq + 30);
        const Outcome outcome = stream.end(10'040);
        expect_account(outcome, 1,
                       {{"samples", 10'010}, {"frames_inconsistent", 2}, {"messages_malformed", 1}});
        EXPECT_EQ(outcome.json()["recordings"][0]["status"], "complete") << name;
        EXPECT_EQ(outcome.json()["recordings"][0]["samples"], 10'010) << name;
        const auto rows = read_rows(*open_reader(folder.file(name)));
        ASSERT_EQ(rows.size(), 2U) << name;
        EXPECT_EQ(rows[0].values.size(), 10'000U) << name;
        EXPECT_EQ(rows[1].first, 10'030) << name;
    }
}

TEST(Listen, FramesOfOtherWidthsAreMalformed) {
    const TemporaryFolder folder;
    FakeStream stream("100", {"-o", folder.file("a.csv")});
    stream.reshape(10, 257);  // more than any array has elements
    stream.send(0, 0);
    stream.reshape(10, 1);
    stream.send(1, 10);
    expect_account(stream.end(20), 1, {{"samples", 10}, {"channels", 1}, {"messages_malformed", 1}});
    EXPECT_EQ(csv_of(folder.file("a.csv")).at("t_s").size(), 10U);
}

/// Returns the program's peak memory [bytes].
std::size_t peak_memory(const Program& program) {
    std::ifstream status(fmt::format("/proc/{}/status", program.process()));
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmHWM:")) {
            return 1024 * std::stoul(line.substr(6));
        }
    }
    return 0;
}

TEST(Listen, ALargeFrameTakesAFewTimesItsSizeOfMemory) {
    if (sanitized) {
        GTEST_SKIP() << "a sanitizer takes memory of its own";
    }
    FakeStream stream("100", {"--stream", "v_chain"}, "v_chain");
    constexpr std::size_t wide = 5'000'000;
    stream.reshape(1, wide);
    stream.send(5, 50);
    stream.reshape(1, 1);
    stream.send(6, 51);
    stream.listener().messages_with("malformed");  // so all is done that is done with the large one
    EXPECT_LT(peak_memory(stream.listener()), 5 * wide * sizeof(float) + (std::size_t{64} << 20));
}

TEST(Listen, RepeatedFaultsAreReportedAFewTimes) {
    FakeStream stream;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        stream.send(2 * i, 20 * i);
        stream.send(2 * i, 20 * i);
    }
    const Outcome outcome = stream.end(40'000);
    expect_account(outcome, 1, {{"frames_lost_on_the_way", 1999}, {"frames_repeated", 2000}});
    EXPECT_LT(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 20);
}

TEST(Listen, AnotherRunMeansThatThisOneBrokeOff) {
    FakeStream stream;
    stream.send(0, 0);
    stream.begin_another_run();
    stream.send(0, 0);
    expect_account(stream.end(10), 1, {{"run", "run-1"}, {"ended_by", "run broke off"}});
}

TEST(Listen, SurvivesNonsense) {
    FakeStream stream;
    stream.send(0, 0);
    stream.send_text(stream.topic);
    stream.send_text(stream.topic, "{}", "abcd");
    stream.send_text(stream.topic, std::string(3000, '['), "abcd");
    stream.send_text("meta", "not JSON");
    stream.send_text("end", std::string(100'000, '['));
    stream.send_text("end", R"({"run": 7})");
    stream.send(1, 10);
    expect_account(stream.end(20), 1, {{"samples", 20}, {"messages_malformed", 4}, {"missing_samples", 0}});
}

TEST(Listen, SurvivesANestedMetaBeforeTheFirstFrame) {
    FakeStream stream;
    stream.send_text("meta", R"({"streams": 3})");
    stream.send_text("meta", R"({"streams":)" + std::string(100'000, '[') + std::string(100'000, ']') + "}");
    expect_account(stream.end(0), 1, {{"ended_by", "end of run"}, {"messages_malformed", 2}});
}

TEST(Listen, EndsAfterTheSamplesThatWereAskedFor) {
    FakeStream stream("100", {"--samples", "25"});
    for (const std::uint64_t seq : {5U, 6U, 7U, 8U}) {
        stream.send(seq, 10 * seq);
    }
    expect_account(stream.fall_silent(), 0,
                   {{"first_sample", 50}, {"samples", 25}, {"ended_by", "duration"}});
    EXPECT_THAT(hertzline({"listen", "--samples", "0", "--duration", "1"}).err,
                AllOf(HasSubstr("--samples: found 0, allowed: a finite number above 0"),
                      HasSubstr("--samples: found --duration, too, allowed: one of them")));
}

TEST(Listen, CtrlCSavesWhatCame) {
    const TemporaryFolder folder;
    Program stream({"stream", "paper-stream", "--bind", any_port});
    Program listener({"listen", "--json", "--connect", stream.endpoint(), "-o", folder.file("heard.csv")});
    listener.messages_with("joined run");
    listener.send(SIGINT);
    const Outcome outcome = listener.wait();
    EXPECT_EQ(outcome.json()["ended_by"], "stopped");
    EXPECT_EQ(csv_of(folder.file("heard.csv")).at("t_s").size(),
              outcome.json()["samples"].get<std::size_t>());
}

/// Returns the number of frames that a stream has sent, by its meters.
std::int64_t frames_sent(Subscriber& meters) {
    return object_of(meters, "meters").value("frames", std::int64_t{0});
}

TEST(Listen, AFloodThatFillsTheQueueIsCountedHonestly) {
    const TemporaryFolder folder;
    const std::string endpoint = "ipc://" + folder.file("s");
    Program stream({"stream", "paper-stream", "--json", "--wait-for-subscriber", "--bind", endpoint,
                    "--queue-memory", "1MiB", "--set", "output.frame_samples=1", "--set",
                    "output.sample_rate_hz=40e3"});
    Program listener({"listen", "--json", "--connect", stream.endpoint(), "-o", folder.file("heard.csv")});
    Subscriber meters(endpoint);
    meters.subscribe("meters");
    while (frames_sent(meters) == 0) {
    }
    listener.send(SIGSTOP);
    constexpr std::int64_t more_than_any_queue = 20'000;
    const std::int64_t before = frames_sent(meters);
    while (frames_sent(meters) < before + more_than_any_queue && !HasFailure()) {
    }
    listener.send(SIGCONT);
    listener.messages_with(std::regex("[1-9][0-9]* lost on the way"));
    listener.send(SIGINT);
    const json account = listener.wait().json();
    EXPECT_FALSE(account["gapless"]);
    EXPECT_GT(account["missing_samples"], 0);
    EXPECT_GT(account["frames_lost_on_the_way"], 0);
    const std::vector<double> times = csv_of(folder.file("heard.csv")).at("t_s");
    EXPECT_EQ(times.size(), account["samples"].get<std::size_t>());
    const double last = times.back() * account["fs"].get<double>();
    const double due = last + 1 - account["first_sample"].get<double>();  // from the first to the last
    EXPECT_NEAR(account["samples"].get<double>() + account["missing_samples"].get<double>(), due, 1e-3);
}

TEST(Listen, SaysAtOnceThatAHostIsNotKnownAndWhatItWaitsFor) {
    const Program unknown({"listen", "--connect", "tcp://no-such-host.invalid:5573"});
    unknown.messages_with("the name of its host is not known");
    unknown.messages_with("waiting for v_out from tcp://no-such-host.invalid:5573");
    for (const char* command : {"get", "set"}) {
        Words words{command, "--connect", "tcp://no-such-host.invalid:5574", "--timeout", "86400"};
        if (command == std::string("set")) {
            words.emplace_back("drive.amplitude_m=1e-6");
        }
        const Outcome outcome = hertzline(words);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_THAT(outcome.err, testing::HasSubstr("the name of its host is not known"));
    }
}

}  // namespace

}  // namespace hertzline::test
