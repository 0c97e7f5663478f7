// A scene that is changed while it is streamed: requests and replies.

#include "stream/control/scene_control.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "tests/support/controlled.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using testing::HasSubstr;

TEST(SceneControl, ChangesTakeEffectAtTheNextBurst) {
    Controlled stream;
    // By hundreds from here it never stands where a burst begins: there a change applies at once.
    stream.advance(50);
    const Json reply = stream.ask({{"set", {{"drive.amplitude_m", 1e-6}}}});
    const auto sample = reply["applies_at_sample"].get<std::int64_t>();
    EXPECT_EQ(sample % 2000, 0);
    EXPECT_EQ(reply["epoch"], 1);
    stream.advance_to(sample);
    EXPECT_EQ(stream.source.epoch().number, 0);
    stream.advance(1);
    EXPECT_EQ(stream.source.epoch(), (Epoch{1, sample, sample / 2000, 1000}));
    const std::vector<EpochOfChange> epochs = stream.control.take_epochs(stream.source.epoch());
    ASSERT_EQ(epochs.size(), 1U);
    EXPECT_EQ(epochs[0].change.sample, sample);
    EXPECT_TRUE(epochs[0].change.goes_on);
    EXPECT_EQ(epochs[0].change.was["drive.amplitude_m"], stream.requested.drive.amplitude_m);
    EXPECT_EQ(scene_hash(epochs[0].resolved.scene), reply["scene_hash"]);
    const Json now = stream.ask({{"get", {"drive.amplitude_m"}}});
    EXPECT_EQ(now["values"]["drive.amplitude_m"]["value"], 1e-6);
    EXPECT_EQ(now["epoch"], 1);
    EXPECT_EQ(now["scene_hash"], reply["scene_hash"]);
}

TEST(SceneControl, ChangesTakeEffectAtOnceWhereBurstsDoNotRepeat) {
    Scene scene = small_scene();
    scene.drive.repetition_hz = 0;
    Controlled stream{scene};
    std::int64_t last = 0;
    for (int change = 1; change <= 20; ++change) {  // some where a piece of the motion ends, some within one
        stream.advance(37);
        const Json reply = stream.ask({{"set", {{"drive.amplitude_m", 1e-6 + 1e-9 * change}}}});
        ASSERT_EQ(reply["epoch"], change) << reply;
        const auto sample = reply["applies_at_sample"].get<std::int64_t>();
        EXPECT_GT(sample, last);
        EXPECT_LE(sample, stream.source.next_sample() + 2);
        last = sample;
    }
}

TEST(SceneControl, EndsWhileAChangeIsPrepared) {  // the pilots of this one may go on for a while
    auto stream = std::make_unique<Controlled>();
    stream->control.take({{"set", {{"numerics.integrator", "leapfrog"}, {"numerics.accuracy", 1e-9}}}},
                         [](const Json& reply) { FAIL() << reply; });
    stream->control.tick();
    ASSERT_TRUE(stream->control.busy());
    stream.reset();
}

TEST(SceneControl, WhatIsNoDriveBeginsAnewAtStaticEquilibrium) {
    Controlled stream;
    const Json reply = stream.ask({{"set", {{"chain.preload_n", 0.2}}}});
    const auto sample = reply["applies_at_sample"].get<std::int64_t>();
    stream.advance_to(sample);
    Samples block = stream.source.make_block(TapSet(Tap::v_last));
    Scene scene = stream.requested;
    scene.chain.preload_n = 0.2;
    Simulation alone(resolve(scene, std::nullopt).scene, stream.source.options());
    constexpr std::size_t most = 10'000;
    Samples expected = alone.make_samples(most);
    ASSERT_EQ(alone.advance(expected, most, TapSet(Tap::v_last)), Status::running);
    ASSERT_GE(stream.source.samples_to_change(), 1000);
    ASSERT_TRUE(stream.source.read(block, 1000, TapSet(Tap::v_last)));
    ASSERT_GE(block.first, sample);  // the stream went on until the reply was there
    const auto since = static_cast<std::size_t>(block.first - sample);
    ASSERT_LE(since + block.count, most);
    EXPECT_TRUE(std::ranges::equal(block[Tap::v_last], expected[Tap::v_last].subspan(since, block.count)));
}

TEST(SceneControl, UndoGoesBackStepByStep) {
    Controlled stream;
    const std::string first = stream.ask({{"get", Json::array()}})["scene_hash"];
    const std::string second = stream.ask({{"set", {{"drive.cycles", 5}}}})["scene_hash"];
    stream.ask({{"set", {{"end.stiffness_n_per_m", 1e6}}}});
    EXPECT_EQ(stream.ask({{"undo", true}})["scene_hash"], second);
    EXPECT_EQ(stream.ask({{"undo", true}})["scene_hash"], first);
    EXPECT_THAT(stream.ask({{"undo", true}})["faults"][0]["found"].get<std::string>(),
                HasSubstr("nothing to undo"));
}

TEST(SceneControl, RefusesWhatIsWrongAndStaysAsItIs) {
    Controlled stream;
    const Json before = stream.ask({{"get", Json::array()}});
    EXPECT_EQ(before["values"]["chain.spheres"]["fixed"], true);
    EXPECT_FALSE(before["values"]["chain.preload_n"].contains("fixed"));
    EXPECT_EQ(stream.ask({{"set", {{"drive.amplitude_m", -1}, {"nothing", 2}}}})["faults"].size(), 2U);
    EXPECT_EQ(stream.ask({{"set", {{"chain.spheres", 7}}}})["faults"][0]["key"], "chain.spheres");
    EXPECT_EQ(
        stream.ask({{"set", {{"numerics.integrator", "leapfrog"}, {"numerics.step_s", 1e-6}}}})["faults"]
            .size(),
        1U);
    for (const Json& nonsense :
         {Json(3), Json(nullptr), Json::object(), Json{{"set", 3}}, Json{{"set", Json::object()}},
          Json{{"undo", false}}, Json{{"get", "all"}}, Json{{"undo", true}, {"get", Json::array()}}}) {
        EXPECT_EQ(stream.ask(nonsense)["faults"].size(), 1U) << nonsense;
    }
    EXPECT_EQ(stream.ask({{"get", Json::array()}}), before);
}

TEST(SceneControl, MergesWhatWaitsAndBoundsIt) {
    Controlled stream;
    std::vector<Json> replies;
    const auto note = [&](const Json& reply) { replies.push_back(reply); };
    for (std::size_t i = 0; i < SceneControl::most_waiting + 3; ++i) {
        stream.control.take({{"set", {{"drive.cycles", 2.0 + 0.1 * static_cast<double>(i)}}}}, note);
    }
    EXPECT_EQ(replies.size(), 3U);  // there was no room
    ASSERT_TRUE(eventually([&] {
        stream.control.tick();
        stream.advance(100);
        return replies.size() == SceneControl::most_waiting + 3;
    }));
    EXPECT_EQ(replies.back()["epoch"], 1);  // all of them are one change
}

TEST(SceneControl, OfWhatWasMergedOnlyTheWrongIsRefused) {
    Controlled stream;
    std::map<int, Json> replies;
    const auto take = [&](int number, const Json& set) {
        stream.control.take({{"set", set}},
                            [&replies, number](const Json& reply) { replies[number] = reply; });
    };
    take(1, {{"drive.amplitude_m", 2e-6}});
    take(2, {{"numerics.step_s", 1e-4}});  // beyond the stability limit, which pilots find
    take(3, {{"drive.cycles", 5.0}});
    ASSERT_TRUE(eventually([&] {
        stream.control.tick();
        stream.advance(100);
        return replies.size() == 3;
    }));
    EXPECT_TRUE(replies[1].contains("applies_at_sample")) << replies[1];
    EXPECT_EQ(replies[2]["faults"][0]["key"], "numerics.step_s") << replies[2];
    EXPECT_TRUE(replies[3].contains("applies_at_sample")) << replies[3];
}

TEST(SceneControl, WithoutRepetitionAChangeFiresABurstAtOnce) {
    const double burst_s = 3e-4;
    EXPECT_EQ(SimulationSource::change_at({}, burst_s, 1e6, 17), 17);
    EXPECT_EQ(SimulationSource::change_at({.repetition_hz = 1000}, burst_s, 1e6, 1), 1000);
    EXPECT_EQ(SimulationSource::change_at({1, 500, 0, 1000}, burst_s, 1e6, 1500), 1500);
    EXPECT_EQ(SimulationSource::change_at({1, 500, 0, 1000}, burst_s, 1e6, 1501), 2500);
}

TEST(SceneControl, NoChangeWaitsForMoreThanASecond) {
    const Epoch rare{.repetition_hz = 0.01};
    EXPECT_EQ(SimulationSource::change_at(rare, 3e-4, 1e6, 5000), 5000);              // the horn rests
    EXPECT_EQ(SimulationSource::change_at(rare, 3e-4, 1e6, 100), 301);                // it plays
    EXPECT_EQ(SimulationSource::change_at(rare, 20, 1e6, 100), 100);                  // for long
    EXPECT_EQ(SimulationSource::change_at(rare, 0.5 + 3e-4, 1e6, 500'100), 500'301);  // it began late
    EXPECT_EQ(SimulationSource::change_at(rare, 3e-4, 1e6, 99'500'000),
              100'000'000);  // the next burst is near
    EXPECT_EQ(SimulationSource::change_at({.repetition_hz = 1e-9}, 3e-4, 1e6, 5000), 5000);
    EXPECT_EQ(SimulationSource::change_at({1, 700, 0, 0.01}, 3e-4, 1e6, 5700), 5700);
}

TEST(SceneControl, AnUndoDoesNotWaitForABurstThatIsFarAway) {
    Controlled stream;
    const Json rare = stream.ask({{"set", {{"drive.repetition_hz", 1e-9}}}});
    stream.advance_to(rare["applies_at_sample"].get<std::int64_t>() + 5000);
    const Json undo = stream.ask({{"undo", true}});
    ASSERT_EQ(undo["epoch"], 2) << undo;
    EXPECT_LE(undo["applies_at_sample"].get<std::int64_t>(), stream.source.next_sample() + 2);
}

TEST(SceneControl, RefusesASceneForWhichTheStreamWouldStand) {
    Controlled stream;
    for (const Json& values : {Json{{"chain.damping_kg_per_s", 1e9}}, Json{{"numerics.step_s", 1e-12}},
                               Json{{"chain.diameter_m", 1e-5}}}) {
        const Json fault = stream.ask({{"set", values}})["faults"][0];
        EXPECT_EQ(fault["key"], values.begin().key()) << fault;
        EXPECT_THAT(fault["found"].get<std::string>(), HasSubstr("a real-time factor of about ")) << values;
        EXPECT_THAT(fault["allowed"].get<std::string>(), HasSubstr("\"force\": true"));
    }
    EXPECT_EQ(stream.ask({{"get", Json::array()}})["epoch"], 0);
}

/// A controlled stream whose samples are computed in a thread of its own.
class Running {
public:
    ~Running() {
        stop_ = true;
        stream.source.interrupt();
        thread_.join();
    }
    /// Asks without simulating meanwhile.
    Json ask(const Json& request) {
        std::optional<Json> reply;
        stream.control.take(request, [&](const Json& json) { reply = json; });
        EXPECT_TRUE(eventually([&] {
            stream.control.tick();
            return reply.has_value();
        }));
        return reply.value_or(Json());
    }
    /// Waits for the samples of that epoch.
    void wait_for_epoch(std::int64_t number) {
        EXPECT_TRUE(eventually([&] {
            stream.control.tick();
            return epoch_.load() >= number;
        }));
    }

    Controlled stream;

private:
    void simulate() {
        while (!stop_) {
            const std::int64_t most = std::min<std::int64_t>(1000, stream.source.samples_to_change());
            if (!stream.source.skip(most)) {
                return;
            }
            epoch_ = stream.source.epoch().number;
        }
    }

    std::atomic<bool> stop_{false};
    std::atomic<std::int64_t> epoch_{0};
    std::thread thread_{[this] { simulate(); }};
};

TEST(SceneControl, AnEpochThatGivesNoBlockIsGivenUpForTheUndo) {
    Running running;
    const Json slow = running.ask({{"set", {{"numerics.step_s", 1e-12}}}, {"force", true}});
    ASSERT_EQ(slow["epoch"], 1) << slow;
    EXPECT_THAT(slow["warnings"].dump(), HasSubstr("begins anew from static equilibrium"));
    const Json undo = running.ask({{"undo", true}});
    ASSERT_EQ(undo["epoch"], 2) << undo;
    running.wait_for_epoch(2);
    const Epoch now{.number = 2, .first_sample = undo["applies_at_sample"], .gave_up = true};
    const std::vector<EpochOfChange> epochs = running.stream.control.take_epochs(now);
    ASSERT_EQ(epochs.size(), 2U);
    EXPECT_FALSE(epochs[1].change.goes_on);  // though only the step changes
    EXPECT_GE(epochs[1].change.sample, epochs[0].change.sample);
}

TEST(SceneControl, ManyEpochsOneAfterTheOtherMayBeGivenUp) {
    Running running;
    for (const Json& request : {Json{{"set", {{"numerics.step_s", 1e-12}}}, {"force", true}},
                                Json{{"set", {{"drive.amplitude_m", 1e-6}}}}, Json{{"undo", true}}}) {
        EXPECT_GT(running.ask(request).value("epoch", 0), 0) << request;  // each of them stands
    }
    const Json undo = running.ask({{"undo", true}});
    ASSERT_EQ(undo["epoch"], 4) << undo;
    running.wait_for_epoch(4);
    const Epoch now{.number = 4, .first_sample = undo["applies_at_sample"], .gave_up = true};
    const std::vector<EpochOfChange> epochs = running.stream.control.take_epochs(now);
    ASSERT_EQ(epochs.size(), 4U);
    for (std::size_t i = 1; i < epochs.size(); ++i) {
        EXPECT_GE(epochs[i].change.sample, epochs[i - 1].change.sample);
        EXPECT_FALSE(epochs[i].change.goes_on) << i;
    }
}

TEST(SceneControl, AStreamThatStandsFromItsStartCanBeChanged) {
    Scene slow = small_scene();
    slow.numerics.step_s = 1e-12;
    Controlled stream{slow, resolve(slow, std::nullopt).scene};
    std::atomic<std::int64_t> epoch{0};
    std::thread simulating([&] {
        while (epoch < 1) {
            const std::int64_t most = std::min<std::int64_t>(1000, stream.source.samples_to_change());
            if (!stream.source.skip(most)) {
                return;
            }
            epoch = stream.source.epoch().number;
        }
    });
    ASSERT_TRUE(eventually([&] { return stream.source.progress() % 2 == 1; }))
        << "it works on its first block";
    std::optional<Json> reply;
    stream.control.take({{"set", {{"numerics.step_s", nullptr}}}}, [&](const Json& json) { reply = json; });
    EXPECT_TRUE(eventually([&] {
        stream.control.tick();
        return epoch >= 1;
    }));
    stream.source.interrupt();
    simulating.join();
    ASSERT_TRUE(reply);
    EXPECT_EQ((*reply)["applies_at_sample"], 1) << *reply;  // its first sample is at rest
}

TEST(SceneControl, WhoAsksForMoreThanTheStreamHasIsToldSo) {
    Scene scene = small_scene();
    scene.drive.repetition_hz = 2;
    const Scene resolved = resolve(scene, std::nullopt).scene;
    SimulationSource source(resolved, TapSet());
    SceneControl control(scene, resolved, source, 300'000);
    std::vector<Json> replies;
    const auto note = [&](const Json& json) { replies.push_back(json); };
    control.take({{"set", {{"drive.amplitude_m", 1e-6}}}}, note);
    ASSERT_TRUE(eventually([&] {
        control.tick();
        source.skip(std::min<std::int64_t>(10, source.samples_to_change()));
        return replies.size() == 1;
    }));
    control.take({{"undo", true}}, note);  // at once: nothing changes any more
    ASSERT_EQ(replies.size(), 2U);
    for (const Json& reply : replies) {
        EXPECT_EQ(reply["faults"][0]["message"], "the stream ends at sample 300000, before this change");
    }
}

TEST(SceneControl, TheReplyHasTheErrorAndTheWarningsOfItsScene) {
    Controlled stream;
    const Json reply = stream.ask({{"set", {{"drive.amplitude_m", 1e-2}}}});
    EXPECT_TRUE(reply["estimated_error"].is_number() || reply["estimated_error"].is_null()) << reply;
    EXPECT_TRUE(reply.contains("estimated_over_s")) << reply;
    EXPECT_FALSE(reply["warnings"].empty()) << reply;
    EXPECT_THAT(stream.ask({{"set", {{"chain.seed", 7}}}})["warnings"].dump(),
                HasSubstr("chain.seed has no effect without chain.tolerance"));
}

TEST(SceneControl, SaysWhichAccuracyWasAskedFor) {
    Controlled stream;
    const auto accuracy = [&] {
        return stream.ask({{"get", {"numerics.accuracy"}}})["values"]["numerics.accuracy"]["value"];
    };
    EXPECT_EQ(accuracy(), nullptr);
    ASSERT_EQ(stream.ask({{"set", {{"numerics.accuracy", 1e-6}}}})["epoch"], 1);
    EXPECT_EQ(accuracy(), 1e-6);
    EXPECT_TRUE(stream.ask({{"set", {{"numerics.step_s", 1e-7}}}}).contains("faults"));
    EXPECT_EQ(stream.ask({{"set", {{"numerics.step_s", 1e-7}, {"numerics.accuracy", nullptr}}}})["epoch"], 2);
}

}  // namespace
}  // namespace hertzline::test
