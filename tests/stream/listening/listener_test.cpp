#include "stream/listening/listener.hpp"

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/listening/run_receiver.hpp"
#include "stream/wire/frame_codec.hpp"
#include "tests/support/sockets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

using namespace std::chrono_literals;

/// A publisher and a listener to it.
class ListenerTest : public testing::Test {
protected:
    void send_meta(std::string_view run) {
        publisher.send("meta", R"({"run": ")" + std::string(run) + R"(", "streams": [{"name": "v_out"}]})");
    }
    void send_frame(const std::string& run, std::uint64_t seq) {
        FrameHeader header;
        header.stream = "v_out";
        header.run = run;
        header.fs = 1e6;
        header.n = 2;
        header.seq = seq;
        header.sample = 2 * seq;
        std::string text;
        encode_header(header, text);
        const std::array<float, 2> values{1, 2};
        publisher.send("v_out/np", std::string_view(text),
                       std::string_view(reinterpret_cast<const char*>(values.data()), sizeof(values)));
    }
    /// Returns the runs of the next `frames` frames.
    std::vector<std::string> runs_of(Listener& listener, std::size_t frames) {
        std::vector<std::string> runs;
        const auto deadline = std::chrono::steady_clock::now() + patience;
        while (runs.size() < frames && !listener.ended() && std::chrono::steady_clock::now() < deadline) {
            if (const ReceivedFrame* frame = listener.receive(10ms)) {
                runs.push_back(frame->header.run);
            }
        }
        return runs;
    }
    /// Sends meta to the waiting listener, and waits until it subscribes to the run's frames.
    void introduce(Listener& listener, std::string_view run) {
        subscriptions_until_wanted(publisher, "meta");
        EXPECT_FALSE(publisher.wanted("v_out/np")) << "not before meta";
        send_meta(run);
        EXPECT_EQ(listener.receive(patience), nullptr);
        subscriptions_until_wanted(publisher, "v_out/np");
    }

    const TemporaryFolder folder;
    const std::string endpoint = "ipc://" + folder.file("s");
    Publisher publisher{endpoint};
};

TEST_F(ListenerTest, GivesTheFramesOfOneRunAfterItsMeta) {
    Listener listener(endpoint);
    introduce(listener, "a");
    send_frame("a", 0);
    send_frame("a", 1);
    EXPECT_THAT(runs_of(listener, 2), testing::ElementsAre("a", "a"));
    send_frame("b", 0);
    EXPECT_THAT(runs_of(listener, 1), testing::IsEmpty());
    EXPECT_TRUE(listener.ended());
    EXPECT_EQ(listener.run().end_reason(), EndReason::run_broke_off);
}

TEST_F(ListenerTest, FollowsEveryRunWhenAskedTo) {
    Listener listener(endpoint, {.runs = ListenerOptions::Runs::every});
    introduce(listener, "a");
    send_frame("a", 0);
    send_frame("b", 5);
    EXPECT_THAT(runs_of(listener, 2), testing::ElementsAre("a", "b"));
    EXPECT_FALSE(listener.ended());
    EXPECT_EQ(listener.run().first_sample(), 10U) << "the account is of the second run";
    listener.want({});
    EXPECT_TRUE(listener.runs().empty());
}

TEST_F(ListenerTest, ATapThatTheRunLacksIsToldOnceAndStaysSo) {
    int told = 0;
    Listener listener(endpoint,
                      {.taps = TapSet(Tap::v_out) | Tap::v_plate, .notify = [&](const std::string& text) {
                           told += text.find("no stream v_plate") != std::string::npos ? 1 : 0;
                       }});
    introduce(listener, "a");
    send_frame("a", 0);
    send_meta("a");
    send_meta("a");
    send_frame("a", 1);
    EXPECT_THAT(runs_of(listener, 2), testing::SizeIs(2));
    publisher.send("end", std::string_view(R"({"run": "a", "samples": 4})"));
    EXPECT_THAT(runs_of(listener, 1), testing::IsEmpty());
    EXPECT_EQ(told, 1);
    EXPECT_EQ(listener.runs().at(Tap::v_out).end_reason(), EndReason::end_of_run);
    EXPECT_EQ(listener.runs().at(Tap::v_plate).end_reason(), EndReason::no_such_stream);
}

TEST_F(ListenerTest, EndsAfterASilenceThatIsNotWaitedFor) {
    Listener polled(endpoint, {.timeout_s = 0.3});
    EXPECT_TRUE(eventually([&] {
        polled.receive(std::chrono::milliseconds(0));
        return polled.ended();
    }));
}

TEST_F(ListenerTest, WaitsNoLongerThanTheSilenceThatEndsIt) {
    Listener silent(endpoint, {.timeout_s = 0.05});
    while (!silent.ended()) {
        EXPECT_EQ(silent.receive(std::chrono::milliseconds::max()), nullptr);  // would never return
    }
    EXPECT_EQ(silent.run().end_reason(), EndReason::silence);
}

TEST_F(ListenerTest, EndsAfterASilenceOrWhenItIsClosed) {
    Listener silent(endpoint, {.timeout_s = 0.05});
    EXPECT_THAT(runs_of(silent, 1), testing::IsEmpty());
    EXPECT_EQ(silent.run().end_reason(), EndReason::silence);
    Listener closed(endpoint);
    closed.close();
    EXPECT_EQ(closed.receive(patience), nullptr);
    EXPECT_EQ(closed.run().end_reason(), EndReason::stopped);
}

TEST(RunReceiver, TellsOfEachReasonOnceHoweverTheyAlternate) {
    std::vector<std::string> told;
    RunReceiver run(Tap::v_out, [&told](const std::string& text) { told.push_back(text); });
    for (int time = 0; time < 3; ++time) {
        run.note_refusal({"it has too many clients", false});
        run.note_refusal({"it closed the connection", false});
    }
    EXPECT_THAT(told, testing::ElementsAre("it has too many clients", "it closed the connection"));
    EXPECT_EQ(run.refusal(), "it closed the connection");
    EXPECT_EQ(run.end_reason(), EndReason{});
    run.note_refusal({"it refused our key", true});
    EXPECT_EQ(run.end_reason(), EndReason::refused);
}

}  // namespace
}  // namespace hertzline::test
