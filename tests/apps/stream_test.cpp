// hertzline stream and hertzline listen, against each other and against the wire's contract.

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/wire/subscriber.hpp"
#include "tests/apps/limit.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Key;
using testing::StartsWith;

struct Heard {
    Outcome stream;
    Outcome listener;
};

/// Streams 2 ms to a listener that receives from sample 0 on.
Heard hear(const std::string& endpoint, const Words& stream_words, const Words& listener_words,
           const std::string& scene = "paper-stream") {
    Program stream(with({"stream", scene, "--pace", "flat-out", "--duration", "2e-3", "--wait-for-subscriber",
                         "--json", "--bind", endpoint},
                        stream_words));
    Program listener(with({"listen", "--json", "--connect", stream.endpoint()}, listener_words));
    Heard heard;
    heard.listener = listener.wait();
    heard.stream = stream.wait();
    EXPECT_EQ(heard.stream.status, 0) << heard.stream.err;
    EXPECT_EQ(heard.listener.status, 0) << heard.listener.err;
    return heard;
}

std::vector<float> as_floats(const std::vector<double>& numbers, std::size_t count) {
    return {numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count)};
}

/// Returns the samples of `hertzline run` for the same 2 ms.
std::map<std::string, std::vector<double>> run_of_the_same(const TemporaryFolder& folder,
                                                           const std::string& scene = "paper-stream") {
    const Outcome run =
        hertzline({"run", scene, "--all", "--set", "output.duration_s=2e-3", "-o", folder.file("run.csv")});
    EXPECT_EQ(run.status, 0) << run.err;
    return csv_of(folder.file("run.csv"));
}

TEST(StreamAndListen, EverySampleOfARunArrivesBitForBit) {
    const TemporaryFolder folder;
    const Heard heard =
        hear(any_port, {"--record", folder.file("record.csv")}, {"-o", folder.file("heard.csv")});
    const auto run = run_of_the_same(folder);
    const auto received = csv_of(folder.file("heard.csv"));
    EXPECT_THAT(received, ElementsAre(Key("t_s"), Key("v_out_m_per_s")));
    EXPECT_EQ(received.at("v_out_m_per_s").size(), 20'000U);
    EXPECT_EQ(as_floats(received.at("v_out_m_per_s"), 20'000), as_floats(run.at("v_out_m_per_s"), 20'000));
    EXPECT_EQ(received.at("t_s"), std::vector(run.at("t_s").begin(), run.at("t_s").end() - 1));

    const auto recorded = csv_of(folder.file("record.csv"));
    EXPECT_EQ(recorded.at("v_out_m_per_s"),
              std::vector(run.at("v_out_m_per_s").begin(), run.at("v_out_m_per_s").end() - 1));

    const json account = heard.listener.json();
    EXPECT_EQ(account["samples"], 20'000);
    EXPECT_EQ(account["missing_samples"], 0);
    EXPECT_EQ(account["gapless"], true);
    EXPECT_EQ(account["ended_by"], "end of run");
    EXPECT_EQ(account["run"], heard.stream.json()["run"]);
}

TEST(StreamAndListen, WholeChainOverAUnixSocket) {
    const TemporaryFolder folder;
    hear("ipc://" + folder.file("s"), {}, {"--stream", "v_chain", "-o", folder.file("heard.csv")});
    const auto run = run_of_the_same(folder);
    const auto received = csv_of(folder.file("heard.csv"));
    ASSERT_EQ(received.size(), 7U);
    for (const char* column : {"v1_m_per_s", "v6_m_per_s"}) {
        EXPECT_EQ(as_floats(received.at(column), 20'000), as_floats(run.at(column), 20'000)) << column;
    }
}

TEST(StreamAndListen, ASymplecticMethodStreamsWhatItGivesInARun) {
    const TemporaryFolder folder;
    const std::string scene = "paper-stream-symplectic";
    const Heard heard = hear(any_port, {}, {"--stream", "v_last", "-o", folder.file("heard.csv")}, scene);
    EXPECT_EQ(heard.stream.json()["integrator"], "chin4a");
    EXPECT_EQ(as_floats(csv_of(folder.file("heard.csv")).at("v_last_m_per_s"), 20'000),
              as_floats(run_of_the_same(folder, scene).at("v_last_m_per_s"), 20'000));
}

TEST(StreamAndListen, DurationOfTheListenerIsExact) {
    const TemporaryFolder folder;
    const Heard heard = hear(any_port, {}, {"--duration", "123.4e-6", "-o", folder.file("heard.csv")});
    EXPECT_EQ(heard.listener.json()["samples"], 1234);
    EXPECT_EQ(csv_of(folder.file("heard.csv")).at("t_s").size(), 1234U);
}

TEST(StreamAndListen, ListenerLearnsThatTheRunHasNoSuchStream) {
    Program stream({"stream", "paper-wall", "--bind", any_port});
    const Outcome listener = hertzline({"listen", "--connect", stream.endpoint(), "--stream", "v_plate"});
    EXPECT_EQ(listener.status, 1);
    EXPECT_THAT(listener.err, HasSubstr("no stream v_plate; it has v_out, v_last, v_chain"));
}

TEST(Stream, MetaMetersAndEndSayWhatTheContractLists) {
    Program stream({"stream", "paper-stream", "--pace", "flat-out", "--duration", "2e-3",
                    "--wait-for-subscriber", "--json", "--bind", any_port});
    Subscriber subscriber(stream.endpoint());
    for (const char* topic : {"meta", "meters", "end", "v_out/raw"}) {
        subscriber.subscribe(topic);
    }
    const json meta = object_of(subscriber, "meta");
    EXPECT_EQ(meta["scene"]["drive"]["repetition_hz"], 1000);
    EXPECT_TRUE(meta["scene"]["numerics"]["step_s"].is_number());
    EXPECT_EQ(meta["version"], HERTZLINE_VERSION);
    std::vector<std::string> names;
    for (const json& each : meta["streams"]) {
        names.push_back(each["name"]);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"v_out", "v_last", "v_plate", "v_chain", "v_horn", "x_horn",
                                               "f_first", "f_last", "f_chain"}));
    for (const char* name : {"scene_hash", "run", "fs", "units"}) {
        EXPECT_TRUE(meta.contains(name)) << name;
    }
    const json meters = object_of(subscriber, "meters");
    for (const char* name : {"real_time_factor", "load", "late_frames", "dropped", "ring_fill",
                             "energy_residual", "contact_events"}) {
        EXPECT_TRUE(meters[name].is_number()) << name;
    }
    const json end = object_of(subscriber, "end");
    const Outcome outcome = stream.wait();
    EXPECT_EQ(end, outcome.json());
    for (const char* name :
         {"simulated_s", "wall_s", "real_time_factor", "steps", "step_s", "integrator", "estimated_error",
          "estimated_over_s", "contact_events", "energy_residual", "frames", "late_frames", "dropped_frames",
          "samples", "load", "scene_hash", "version", "run", "endpoint"}) {
        EXPECT_TRUE(end.contains(name)) << name;
    }
    EXPECT_EQ(end["samples"], 20'000);
    EXPECT_LE(meta["estimated_error"].get<double>(), 1e-4);
    EXPECT_EQ(end["estimated_error"], meta["estimated_error"]);
    EXPECT_EQ(end["estimated_over_s"], meta["estimated_over_s"]);
    EXPECT_GT(meta["estimated_over_s"].get<double>(), 0);
    EXPECT_EQ(end["run"], meta["run"]);
    EXPECT_EQ(end["scene_hash"], meta["scene_hash"]);
}

TEST(Stream, CountsOfTopicsWithoutSubscribersAreInJsonOnly) {
    const Words words{"stream", "paper-wall", "--duration", "1e-3", "--bind", any_port};
    EXPECT_EQ(hertzline(with(words, {"--json"})).json()["v_last_np_sent"], 0);
    const std::string text = hertzline(words).out;
    EXPECT_THAT(text, HasSubstr("late_frames"));
    EXPECT_THAT(text, Not(HasSubstr("_sent")));
}

TEST(Stream, CtrlCEndsItWithASummaryAndAReadableRecording) {
    for (const int signal : {SIGINT, SIGTERM}) {
        const TemporaryFolder folder;
        // a rate at which a CSV keeps up, also where each line takes long
        Program stream({"stream", "paper-stream", "--set", "output.sample_rate_hz=1e5", "--json", "--record",
                        folder.file("r.csv"), "--bind", any_port});
        Subscriber subscriber(stream.endpoint());
        subscriber.subscribe("v_out/raw");
        ASSERT_NE(subscriber.receive(std::chrono::seconds(60)), nullptr);
        stream.send(signal);
        const Outcome outcome = stream.wait();
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const auto recorded = csv_of(folder.file("r.csv"));
        EXPECT_EQ(recorded.at("t_s").size(), outcome.json()["samples"].get<std::size_t>());
        EXPECT_GT(recorded.at("t_s").size(), 0U);
    }
}

TEST(Stream, EstimatesTheErrorAgainWhenTheMotionGrows) {
    // a hundredth of real time: the motion has grown after some tenths of a second, and reaching it takes as long
    Program stream({"stream", "paper-acrylic", "--set", "drive.repetition_hz=2000", "--pace", "0.01",
                    "--json", "--bind", any_port});
    Subscriber subscriber(stream.endpoint());
    subscriber.subscribe("meta");
    const json before = object_of(subscriber, "meta");
    json meta = before;
    for (int metas = 0; metas < 100 && meta["estimated_over_s"] == before["estimated_over_s"]; ++metas) {
        meta = object_of(subscriber, "meta");
    }
    EXPECT_GT(meta["estimated_over_s"], before["estimated_over_s"]);
    EXPECT_LE(before["estimated_error"], 1e-4);
    EXPECT_GT(meta["estimated_error"], 1e-4);
    EXPECT_EQ(meta["step_s"], before["step_s"]);
    EXPECT_EQ(meta["run"], before["run"]);
    stream.send(SIGINT);
    const Outcome outcome = stream.wait();
    EXPECT_EQ(outcome.status, 0);
    EXPECT_GE(outcome.json()["estimated_over_s"], meta["estimated_over_s"]);
    EXPECT_THAT(outcome.err, HasSubstr("above the requested accuracy of 0.0001"));
}

TEST(Stream, CtrlCEndsAnEstimateThatIsBeingMade) {
    Program stream(
        {"stream", "paper-acrylic", "--set", "drive.repetition_hz=2000", "--json", "--bind", any_port});
    const std::string tasks = "/proc/" + std::to_string(stream.process()) + "/task";
    const auto estimating = [&] {
        for (const auto& task : std::filesystem::directory_iterator(tasks)) {
            std::ifstream name(task.path() / "comm");
            std::string text;
            if (std::getline(name, text) && text == "estimating") {
                return true;
            }
        }
        return false;
    };
    const auto deadline = std::chrono::steady_clock::now() + Program::long_enough;
    while (!estimating() && std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    stream.send(SIGINT);
    const Outcome outcome = stream.wait();
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("the motion has left the range of the error estimate"));
}

TEST(Stream, CtrlCWhileWaitingForASubscriberEndsIt) {
    Program stream({"stream", "paper-stream", "--json", "--wait-for-subscriber", "--bind", any_port});
    stream.messages_with("waiting for a subscriber");
    stream.send(SIGINT);
    const Outcome outcome = stream.wait();
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.json()["samples"], 0);
}

TEST(Stream, WhatMayWaitForItsFilesIsCountedForEachOfThem) {
    const TemporaryFolder folder;
    std::vector<std::string> words{
        "stream", "paper-stream",      "--pace",   "flat-out",          "--duration", "1e-6",
        "--bind", "tcp://127.0.0.1:*", "--record", folder.file("0.npy")};
    const Outcome one = hertzline(words);
    EXPECT_EQ(one.status, 0) << one.err;
    for (int i = 1; i < 2048; ++i) {
        words.insert(words.end(), {"--record", folder.file(std::to_string(i) + ".npy")});
    }
    const Outcome many = hertzline(words);  // 256 MiB each
    EXPECT_EQ(many.status, 1);
    EXPECT_THAT(many.err, testing::ContainsRegex("needs 51[234]\\.[0-9] GiB of memory"));
}

TEST(Stream, AsksForAllTheDescriptorsThatItMayHave) {
    std::optional<Limit> few(std::in_place, RLIMIT_NOFILE, 256);
    const rlim_t highest = few->highest();
    Program stream({"stream", "paper-stream", "--bind", any_port});
    few.reset();
    stream.endpoint();
    const std::string limits = contents("/proc/" + std::to_string(stream.process()) + "/limits");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(limits, found, std::regex("Max open files +([0-9]+) +([0-9]+)"))) << limits;
    EXPECT_EQ(found[1], found[2]);
    EXPECT_EQ(found[2], std::to_string(highest));
}

TEST(Stream, SaysHowToListen) {
    Program stream({"stream", "paper-stream", "--bind", any_port});
    const std::string endpoint = stream.endpoint();
    EXPECT_THAT(endpoint, StartsWith("tcp://127.0.0.1:"));
    EXPECT_THAT(stream.messages_with("hertzline listen"), HasSubstr("--connect " + endpoint));
}

}  // namespace

}  // namespace hertzline::test
