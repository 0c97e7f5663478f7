// hertzline listen against streams that are interrupted, flooded, wrong or hostile.

#include <csignal>
#include <regex>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/wire/frame_codec.hpp"
#include "stream/wire/publisher.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string any_port = "tcp://127.0.0.1:*";
constexpr std::string_view topic = "v_out/np";

/// A stream that sends what a test tells it to, to one listener.
class FakeStream {
public:
    explicit FakeStream(const std::string& timeout_s = "100")
        : publisher_(any_port),
          listener_(Words{"listen", "--json", "--timeout", timeout_s, "--connect", publisher_.endpoint()}) {
        frame_.stream = "v_out";
        frame_.run = "run-1";
        frame_.fs = 1e6;
        frame_.n = 10;
        for (int tries = 0; tries < 6000 && !publisher_.wanted(topic); ++tries) {
            if (publisher_.poll_subscriptions() > 0) {
                send_text("meta", R"({"streams": [{"name": "v_out"}]})");
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        EXPECT_TRUE(publisher_.wanted(topic)) << "nobody listens";
    }

    /// A frame of ten samples.
    void send(std::uint64_t seq, std::uint64_t sample, std::uint64_t dropped = 0) {
        frame_.seq = seq;
        frame_.sample = sample;
        frame_.dropped = dropped;
        std::string header;
        encode_header(frame_, header);
        send_text(topic, header, std::string(frame_.payload_bytes(), '\0'));
    }
    void begin_another_run() { frame_.run = "run-2"; }
    template <class... Parts>
    void send_text(std::string_view to, const Parts&... parts) {
        EXPECT_TRUE(publisher_.send(to, std::string_view(parts)...));
    }
    Outcome end(std::int64_t samples, std::int64_t dropped_frames = 0) {
        send_text("end",
                  json{{"run", frame_.run}, {"samples", samples}, {"dropped_frames", dropped_frames}}.dump());
        return fall_silent();
    }
    Outcome fall_silent() { return listener_.wait(); }

private:
    using Words = std::vector<std::string>;
    Publisher publisher_;
    Program listener_;
    FrameHeader frame_;
};

/// The listener ended with this status, and its account says this.
void expect_account(const Outcome& outcome, int status, const json& expected) {
    EXPECT_EQ(outcome.status, status) << outcome.err;
    const json account = outcome.json();
    for (const auto& [name, value] : expected.items()) {
        EXPECT_EQ(account.at(name), value) << name;
    }
}

TEST(Listen, JoiningLateIsNoGap) {
    FakeStream stream;
    stream.send(5, 50);
    stream.send(6, 60);
    const Outcome outcome = stream.end(70);
    expect_account(outcome, 0, {{"first_sample", 50}, {"samples", 20}});
    EXPECT_THAT(outcome.err, HasSubstr("joined run run-1 at sample 50"));
}

TEST(Listen, TellsWhoseLossAGapIs) {
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

TEST(Listen, TheEndTellsOfSamplesThatNeverCame) {
    FakeStream stream;
    stream.send(0, 0);
    expect_account(stream.end(30), 1, {{"missing_samples", 20}, {"ended_by", "end of run"}});
}

TEST(Listen, TheEndTellsOfFramesThatTheSenderDroppedLast) {
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

TEST(Listen, RepeatedAndLateFramesAreNotKept) {
    FakeStream stream;
    stream.send(3, 30);
    stream.send(3, 30);
    stream.send(1, 10);
    expect_account(stream.end(40), 1, {{"samples", 10}, {"frames_repeated", 1}, {"frames_out_of_order", 1}});
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
    stream.send_text(topic);
    stream.send_text(topic, "{}", "abcd");
    stream.send_text(topic, std::string(3000, '['), "abcd");
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

TEST(Listen, CtrlCSavesWhatCame) {
    const TemporaryFolder folder;
    Program stream({"stream", "paper-stream", "--bind", any_port});
    Program listener({"listen", "--json", "--connect", stream.endpoint(), "-o", folder.file("heard.csv")});
    listener.messages_with("joined run");
    listener.send(SIGINT);
    const Outcome outcome = listener.wait(std::chrono::seconds(10));
    EXPECT_EQ(outcome.json()["ended_by"], "stopped");
    EXPECT_EQ(csv_of(folder.file("heard.csv")).at("t_s").size(),
              outcome.json()["samples"].get<std::size_t>());
}

/// Frames that a stream has sent, as its meters tell.
std::int64_t frames_sent(Subscriber& meters) {
    return object_of(meters, "meters").value("frames", std::int64_t{0});
}

TEST(Listen, AFloodThatFillsTheQueueIsCountedHonestly) {
    const TemporaryFolder folder;
    const std::string endpoint = "ipc://" + folder.file("s");
    Program stream({"stream", "paper-stream", "--json", "--wait-for-subscriber", "--bind", endpoint, "--set",
                    "output.frame_samples=1", "--set", "output.sample_rate_hz=40e3"});
    Program listener({"listen", "--json", "--connect", stream.endpoint(), "-o", folder.file("heard.csv")});
    Subscriber meters(endpoint);
    meters.subscribe("meters");
    while (frames_sent(meters) == 0) {
    }
    listener.send(SIGSTOP);
    constexpr std::int64_t more_than_any_queue = 80'000;
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

}  // namespace

}  // namespace hertzline::test
