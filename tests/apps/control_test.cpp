// hertzline set and hertzline get against a running stream, and its recordings simulated again.

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "recordings/recording_formats.hpp"
#include "stream/control/control_client.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/simulated_again.hpp"
#include "tests/support/files.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;

namespace {

using testing::HasSubstr;

/// A stream that is controlled.
class LiveStream {
public:
    explicit LiveStream(const Words& more = {}, const std::string& scene = "paper-stream",
                        const std::string& sample_rate_hz = "1e6")
        : program(with({"stream", scene, "--set", "output.sample_rate_hz=" + sample_rate_hz, "--json",
                        "--bind", any_port, "--control", any_port},
                       more)) {
        const std::regex said("control (tcp://\\S+)");
        const std::string messages = program.messages_with(said);
        std::smatch found;
        std::regex_search(messages, found, said);
        control = found[1];
    }
    Json ask(const Json& request) const {
        return ask_control({.endpoint = control, .timeout_s = 100}, request, never);
    }

    Program program;
    std::string control;
    std::atomic<bool> never{false};
};

/// Returns a random change, as a controller may request it.
Json random_change(std::mt19937& random) {
    const auto from_to = [&](double from, double to) {
        return std::uniform_real_distribution(from, to)(random);
    };
    switch (std::uniform_int_distribution(0, 6)(random)) {
        case 0:
            return {{"set", {{"drive.amplitude_m", from_to(1e-7, 4e-6)}}}};
        case 1:
            return {{"set", {{"drive.frequency_hz", from_to(5e4, 9e4)}, {"drive.cycles", from_to(3, 30)}}}};
        case 2:
            return {{"set", {{"drive.repetition_hz", from_to(700, 1300)}, {"drive.envelope", "tukey"}}}};
        case 3:
            return {{"set", {{"chain.preload_n", from_to(0.05, 0.5)}}}};
        case 4:
            return {{"set", {{"end.thickness_m", from_to(3e-4, 8e-4)}}}};
        case 5:
            return {{"set",
                     {{"end.materials", {"aluminium", "acrylic"}},
                      {"end.thicknesses_m", {from_to(1e-4, 3e-4), from_to(2e-4, 6e-4)}},
                      {"end.thicknesses_m[2]", "0.4 mm"}}}};
        default:
            return {{"undo", true}};
    }
}

TEST(Control, SetsGetsAndUndoes) {
    LiveStream stream;
    const auto at = [&](Words words) {
        return hertzline(with(std::move(words), {"--connect", stream.control, "--json"}));
    };
    const Json before = Json::parse(at({"get"}).out);
    EXPECT_EQ(before["epoch"], 0);
    const Outcome set = at({"set", "drive.amplitude_m=2e-6", "drive.envelope=tukey"});
    ASSERT_EQ(set.status, 0) << set.err;
    EXPECT_EQ(set.json()["epoch"], 1);
    const Json got = Json::parse(at({"get", "drive.amplitude_m"}).out);
    EXPECT_EQ(got["values"]["drive.amplitude_m"]["value"], 2e-6);
    EXPECT_EQ(got["scene_hash"], set.json()["scene_hash"]);

    const Outcome as_text = hertzline({"get", "drive.envelope", "--connect", stream.control});
    EXPECT_THAT(as_text.out, testing::ContainsRegex("drive.envelope +tukey\nepoch +1\n")) << as_text.err;

    const Outcome wrong = at({"set", "drive.amplitude_m=-1", "chain.spheres=5"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("drive.amplitude_m: found -1, allowed: a number from 0 to 1 m"));
    EXPECT_EQ(at({"set", "--undo"}).json()["scene_hash"], before["scene_hash"]);

    stream.program.messages_with("epoch 2 from sample");
    stream.program.send(SIGINT);
    const Outcome ended = stream.program.wait();
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.json()["scene_hash"], before["scene_hash"]);
    EXPECT_THAT(ended.err, HasSubstr("drive.amplitude_m = 2e-06"));
}

TEST(Control, SetsListsAndTheirEntries) {
    LiveStream stream;
    const auto at = [&](Words words) {
        return hertzline(with(std::move(words), {"--connect", stream.control, "--json"}));
    };
    const auto thicknesses = [&] {
        return Json::parse(at({"get", "end.thicknesses_m"}).out)["values"]["end.thicknesses_m"]["value"];
    };
    const Json before = Json::parse(at({"get"}).out);
    EXPECT_EQ(thicknesses(), nullptr);
    const Outcome set = at({"set", "end.materials=[aluminium,acrylic]", "end.thicknesses_m=[0.2mm, 0.5mm]"});
    ASSERT_EQ(set.status, 0) << set.err;
    EXPECT_EQ(thicknesses(), Json({2e-4, 5e-4}));
    ASSERT_EQ(at({"set", "end.thicknesses_m[2]=0.4mm"}).status, 0);
    EXPECT_EQ(thicknesses(), Json({2e-4, 4e-4}));
    const Outcome wrong = at({"set", "end.thicknesses_m[3]=1", "end.materials[1]=watr"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(
        wrong.err,
        HasSubstr(
            "end.thicknesses_m[3]: found entry 3, allowed: end.thicknesses_m[1] to end.thicknesses_m[2]"));
    EXPECT_THAT(wrong.err, HasSubstr("end.materials[1]: found \"watr\""));
    EXPECT_EQ(at({"set", "--undo"}).status, 0);
    EXPECT_EQ(thicknesses(), Json({2e-4, 5e-4}));
    ASSERT_EQ(at({"set", "end.materials=null", "end.thicknesses_m=null"}).status, 0);
    EXPECT_EQ(Json::parse(at({"get"}).out)["scene_hash"], before["scene_hash"]);
}

TEST(Control, ReportsTheFaultsOfItsArguments) {
    EXPECT_EQ(hertzline({"set"}).status, 2);
    EXPECT_EQ(hertzline({"set", "drive.cycles"}).status, 2);
    EXPECT_EQ(hertzline({"set", "drive.cycles=3", "--undo"}).status, 2);
    const Outcome nobody = hertzline({"get", "--connect", "tcp://127.0.0.1:9", "--timeout", "0.2"});
    EXPECT_EQ(nobody.status, 1);
    EXPECT_THAT(nobody.err, HasSubstr("tcp://127.0.0.1:9: nothing is there"));
    const Outcome exposed =
        hertzline({"stream", "paper-stream", "--control", "tcp://0.0.0.0:*", "--insecure"});
    EXPECT_EQ(exposed.status, 2);
    EXPECT_THAT(exposed.err, HasSubstr("--allow-controllers"));
    EXPECT_EQ(hertzline({"stream", "paper-stream", "--allow-controllers", "x.key"}).status, 2);
}

/// Takes a processor from the stream.
class Load {
public:
    ~Load() {
        done_ = true;
        thread_.join();
    }

private:
    std::atomic<bool> done_{false};
    std::thread thread_{[this] {
        while (!done_) {
        }
    }};
};

/// Makes `wanted` random changes, ends the stream when the last has taken effect, and waits for it.
Outcome session_of_random_changes(LiveStream& stream, int wanted) {
    {
        const Load load;
        std::mt19937 random(14);
        for (int changes = 0; changes < wanted;) {
            changes += stream.ask(random_change(random)).contains("epoch") ? 1 : 0;
        }
    }
    stream.program.messages_with("epoch " + std::to_string(wanted) + " from sample");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stream.program.send(SIGINT);
    return stream.program.wait();
}

TEST(Control, ASessionOfRandomChangesIsSimulatedAgainBitForBit) {
    const TemporaryFolder folder;
    const std::vector<std::string> files{folder.file("a.sigmf-meta"), folder.file("a.h5"),
                                         folder.file("a.npy"), folder.file("a.wav"), folder.file("a.csv")};
    Words words{"--columns", "v_out"};
    for (const std::string& file : files) {
        words = with(words, {"--record", file});
    }
    LiveStream stream(words);
    Program listener(
        {"listen", "--connect", stream.program.endpoint(), "-o", folder.file("heard.h5"), "--json"});
    const int wanted = sanitized ? 8 : 50;
    const Outcome ended = session_of_random_changes(stream, wanted);
    ASSERT_EQ(ended.status, 0) << ended.err;
    const Outcome heard = listener.wait();
    ASSERT_EQ(heard.status, 0) << heard.err;

    const Json changes = changes_in_file(files[0]);
    EXPECT_EQ(changes.size(), static_cast<std::size_t>(wanted));
    for (const std::string& file : files) {
        EXPECT_EQ(changes_in_file(file), changes) << file;
    }
    const std::vector<double> recorded = numbers_in(files[1]);
    EXPECT_TRUE(recorded == simulated_again(files[1], folder.file("again.h5")));
    EXPECT_EQ(changes_in_file(folder.file("again.h5")), changes);
    EXPECT_TRUE(numbers_in(files[0]) == simulated_again(files[0], folder.file("again.sigmf-meta")));
    const std::vector<double> caught = numbers_in(folder.file("heard.h5"));
    const auto joined = heard.json()["first_sample"].get<std::ptrdiff_t>();
    const std::vector<double> all =
        simulated_again(folder.file("heard.h5"), folder.file("reheard.sigmf-meta"));
    EXPECT_TRUE(std::equal(caught.begin(), caught.end(), all.begin() + joined, all.end()));
}

TEST(Control, AtTenMillionSamplesASecondTheSessionIsStillBitForBit) {
    if (sanitized) {
        GTEST_SKIP() << "with sanitizers it is not simulated in real time";
    }
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sigmf-meta");
    // on a busy machine it may fall behind, and loses nothing
    LiveStream stream({"--columns", "v_out", "--record", file, "--on-overrun", "wait"}, "paper-stream",
                      "10e6");
    const Outcome ended = session_of_random_changes(stream, 50);
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(changes_in_file(file).size(), 50U);
    EXPECT_TRUE(numbers_in(file) == simulated_again(file, folder.file("again.sigmf-meta")));
}

TEST(Control, TheSummaryOfAStreamIsThatOfARunOfItsRecording) {
    const TemporaryFolder folder;
    for (const std::string scene : {"paper-stream", "paper-stream-symplectic"}) {
        const std::string file = folder.file(scene + ".h5");
        LiveStream stream({"--record", file, "--on-overrun", "wait"}, scene);
        EXPECT_EQ(stream.ask({{"set", {{"drive.amplitude_m", 2e-6}}}})["epoch"], 1);
        const Json last = stream.ask({{"set", {{"chain.preload_n", 0.2}}}});
        EXPECT_EQ(last["epoch"], 2) << last;
        Subscriber subscriber(stream.program.endpoint());
        subscriber.subscribe("v_out/np");
        for (std::int64_t epoch = 0; epoch < 2;) {
            const Message* message = subscriber.receive(std::chrono::seconds(60));
            ASSERT_NE(message, nullptr);
            epoch = Json::parse(message->text(0))["epoch"];
        }
        stream.program.send(SIGINT);  // it has simulated samples that it no longer sends
        const Outcome streamed = stream.program.wait();
        ASSERT_EQ(streamed.status, 0) << streamed.err;
        const Outcome again = hertzline({"run", file, "--json"});
        ASSERT_EQ(again.status, 0) << again.err;
        const Json a = streamed.json();
        const Json b = again.json();
        ASSERT_TRUE(a["estimated_error"].is_number());
        EXPECT_EQ(a["estimated_error"], b["estimated_error"]) << scene;
        EXPECT_EQ(a["estimated_over_s"], b["estimated_over_s"]) << scene;
        EXPECT_EQ(a["contact_events"], b["contact_events"]) << scene;
        EXPECT_NEAR(a["energy_residual"].get<double>(), b["energy_residual"].get<double>(),
                    1e-6 * b["energy_residual"].get<double>())
            << scene;
        EXPECT_GE(a["estimated_error"], last["estimated_error"]);
    }
}

TEST(Control, ARecordingWhoseListOfChangesIsMissingIsNotSimulatedAgain) {
    const TemporaryFolder folder;
    const auto file = [&](const std::string& ending) { return folder.file("a" + ending); };
    const std::vector<std::string> endings{".wav", ".sigmf-meta", ".csv", ".h5", ".npy"};
    Words words{"--columns", "v_out"};
    for (const std::string& ending : endings) {
        words = with(words, {"--record", file(ending)});
    }
    LiveStream stream(words);
    stream.program.messages_with("run ");
    stream.program.send(SIGINT);
    ASSERT_EQ(stream.program.wait().status, 0);
    for (const std::string& ending : endings) {  // nothing has changed, and that is known
        const Outcome run = hertzline({"run", file(ending)});
        EXPECT_EQ(run.status, 0) << ending << run.err;
        EXPECT_EQ(open_reader(file(ending))->head().provenance["changes"], Json::array()) << ending;
    }
    std::filesystem::remove(file(".wav") + "-changes.json");
    Json meta = Json::parse(std::ifstream(file(".sigmf-meta")));
    meta["global"].erase("hertzline:changes");
    write_text(file(".sigmf-meta"), meta.dump());
    for (const char* ending : {".wav", ".sigmf-meta"}) {
        const Outcome run = hertzline({"run", file(ending)});
        EXPECT_EQ(run.status, 2) << ending;
        EXPECT_THAT(run.err, HasSubstr("the list of changes is missing")) << ending;
    }
}

TEST(Control, AKilledSessionIsSimulatedAgainAsFarAsItsChangesAreKnown) {
    const TemporaryFolder folder;
    const std::string sigmf = folder.file("a.sigmf-meta");
    const std::string csv = folder.file("a.csv");
    LiveStream stream({"--columns", "v_out", "--record", sigmf, "--record", csv});
    for (int change = 1; change <= 30; ++change) {
        ASSERT_EQ(stream.ask({{"set", {{"drive.cycles", 3 + 0.1 * change}}}})["epoch"], change);
    }
    stream.program.messages_with("epoch 30 from sample");
    const auto partial = [&] {
        return std::vector<std::filesystem::directory_entry>(
            std::filesystem::directory_iterator(folder.file("")), {});
    };
    const auto tells_of_changes = [](const std::filesystem::directory_entry& entry) {
        return entry.path().string().find("a.csv-metadata.json") != std::string::npos &&
               std::regex_search(contents(entry.path()), std::regex("\"changes_until_sample\": ?[1-9]"));
    };
    while (std::ranges::none_of(partial(), tells_of_changes)) {  // half a second after the last time
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    stream.program.send(SIGKILL);
    stream.program.wait();
    auto left = partial();
    std::ranges::sort(left, {}, [](const auto& entry) { return entry.last_write_time(); });
    for (const auto& entry : left) {
        const std::string name = entry.path().string();
        const std::string whole = name.substr(0, name.find(".partial-"));
        if (!std::filesystem::exists(whole)) {  // else it was killed while it wrote newer metadata
            std::filesystem::rename(name, whole);
        }
    }
    for (const auto& [file, as] :
         {std::pair(sigmf, folder.file("again.sigmf-meta")), std::pair(csv, folder.file("again.csv"))}) {
        const std::vector<double> recorded = numbers_in(file);
        const std::vector<double> again = simulated_again(file, as);
        ASSERT_GT(again.size(), 1U) << file;
        ASSERT_LE(again.size(), recorded.size()) << file;
        EXPECT_TRUE(std::equal(again.begin(), again.end(), recorded.begin())) << file;
    }
}

TEST(Control, AReplayedSessionHasItsScenesOneAfterAnother) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.h5");
    LiveStream stream({"--columns", "v_out", "--record", file});
    Json changes = Json::array();
    for (const double amplitude : {2e-6, 1e-6, 4e-6}) {
        changes.push_back(
            stream.ask({{"set", {{"drive.amplitude_m", amplitude}, {"drive.repetition_hz", 999}}}}));
    }
    stream.program.messages_with("epoch 3 from sample");
    stream.program.send(SIGINT);
    ASSERT_EQ(stream.program.wait().status, 0);

    Program replay({"replay", file, "--pace", "flat-out", "--wait-for-subscriber", "--bind", any_port});
    Subscriber subscriber(replay.endpoint());
    subscriber.subscribe("meta");
    EXPECT_EQ(object_of(subscriber, "meta")["changes"], Json::array());
    const std::string heard = folder.file("b.h5");
    const Outcome listener = hertzline({"listen", "--connect", replay.endpoint(), "-o", heard});
    ASSERT_EQ(listener.status, 0) << listener.err;
    EXPECT_EQ(changes_in_file(heard), changes_in_file(file));
    EXPECT_TRUE(numbers_in(file) == simulated_again(heard, folder.file("again.h5")));
    for (int epoch = 0; epoch < 3;) {
        const Json meta = object_of(subscriber, "meta");
        ASSERT_TRUE(meta.is_object());
        const int now = meta["epoch"].get<int>();
        EXPECT_EQ(meta["changes"].size(), now);
        if (now > epoch) {
            const Json& reply = changes[static_cast<std::size_t>(now) - 1];
            EXPECT_EQ(meta["scene_hash"], reply["scene_hash"]);
            EXPECT_EQ(meta["estimated_error"], reply["estimated_error"]);
            EXPECT_EQ(meta["epoch_sample"], reply["applies_at_sample"]);
            EXPECT_EQ(meta["scene"]["drive"]["amplitude_m"],
                      meta["changes"].back()["set"]["drive.amplitude_m"]);
            EXPECT_EQ(meta["step_s"], meta["scene"]["numerics"]["step_s"]);
            epoch = now;
        }
    }
}

TEST(Control, AStreamThatWaitsForASubscriberSaysSo) {
    LiveStream stream({"--wait-for-subscriber"});
    const Json change{{"set", {{"drive.amplitude_m", 2e-6}}}};
    EXPECT_EQ(stream.ask(change)["faults"][0]["message"],
              "found a stream that waits for its first subscriber, allowed: changes when it has begun");
    EXPECT_EQ(stream.ask({{"get", Json::array()}})["epoch"], 0);
    Subscriber subscriber(stream.program.endpoint());
    subscriber.subscribe("v_out/np");
    ASSERT_NE(subscriber.receive(std::chrono::seconds(60)), nullptr);
    EXPECT_EQ(stream.ask(change)["epoch"], 1);
}

TEST(Control, WhatIsTooSlowIsRefusedAndAStreamThatStandsComesBack) {
    if (sanitized) {
        GTEST_SKIP() << "with sanitizers every scene is slow";
    }
    const TemporaryFolder folder;
    const std::string file = folder.file("a.h5");
    LiveStream stream({"--columns", "v_out", "--record", file});
    const auto at = [&](Words words) {
        return hertzline(with(std::move(words), {"--connect", stream.control, "--timeout", "100"}));
    };
    const Outcome refused = at({"set", "numerics.step_s=1e-12"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("a real-time factor of about"));
    EXPECT_THAT(refused.err, HasSubstr("--force"));
    const Outcome forced = at({"set", "numerics.step_s=1e-12", "--force"});
    ASSERT_EQ(forced.status, 0) << forced.err;
    EXPECT_THAT(forced.err, HasSubstr("an undo begins anew"));
    stream.program.messages_with("s late");  // by the clock: no frame comes
    ASSERT_EQ(at({"set", "--undo"}).status, 0);
    stream.program.messages_with("epoch 2 from sample");
    ASSERT_EQ(at({"set", "drive.cycles=5"}).status, 0);
    stream.program.messages_with("epoch 3 from sample");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stream.program.send(SIGINT);
    const Outcome ended = stream.program.wait();
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_GT(ended.json()["largest_lateness_s"], 1.0);
    EXPECT_TRUE(numbers_in(file) == simulated_again(file, folder.file("again.h5")));
}

TEST(Control, AStreamThatGivesNoFrameSaysSo) {
    if (sanitized) {
        GTEST_SKIP() << "with sanitizers every scene is slow";
    }
    Program program(
        {"stream", "paper-stream", "--set", "numerics.step_s=1e-12", "--bind", any_port, "--json"});
    program.messages_with("a real-time factor of about");
    program.messages_with("s late, at 0 of real time");
    program.send(SIGINT);
    EXPECT_GT(program.wait().json()["largest_lateness_s"], 1.0);
}

TEST(Control, AnOwnMaterialsDensityHasItsShortNameToo) {
    const TemporaryFolder folder;
    write_text(folder.file("s.toml"), R"(
[materials.mine]
youngs_modulus_pa = 2e11
poissons_ratio = 0.3
density = 7800
[chain]
material = "mine"
[drive]
repetition_hz = 1000
)");
    const LiveStream stream({}, folder.file("s.toml"));
    const Outcome set = hertzline({"set", "materials.mine.density=8000", "--connect", stream.control});
    EXPECT_EQ(set.status, 0) << set.err;
    const Outcome got = hertzline({"get", "materials.mine.density_kg_per_m3", "--connect", stream.control});
    EXPECT_THAT(got.out, HasSubstr("8000"));
    const Outcome both = hertzline({"set", "materials.mine.density=8000",
                                    "materials.mine.density_kg_per_m3=8100", "--connect", stream.control});
    EXPECT_EQ(both.status, 2);
    EXPECT_THAT(both.err, HasSubstr("not both"));
}

}  // namespace
}  // namespace hertzline::test
