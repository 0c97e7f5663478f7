// A scene that is changed while it is streamed: requests and replies, epochs in frames, nothing missing, nothing allocated.

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "stream/control/control_client.hpp"
#include "stream/control/control_server.hpp"
#include "stream/control/scene_control.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/seen_scenes.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using testing::HasSubstr;

/// Returns a scene with a burst each 2000 samples.
Scene small_scene() {
    Scene scene = steady_scene();
    scene.output.sample_rate_hz = 2e6;
    return scene;
}

struct Controlled {
    Scene requested = small_scene();
    Scene resolved = resolve(requested, std::nullopt).scene;
    SimulationSource source{resolved, TapSet()};
    SceneControl control{requested, resolved, source};

    /// Sends a request, and continues the stream until there is a reply.
    Json ask(const Json& request) {
        std::optional<Json> reply;
        control.take(request, [&](const Json& json) { reply = json; });
        EXPECT_TRUE(eventually([&] {
            control.tick();
            if (!reply && control.busy()) {
                advance(100);
            }
            return reply.has_value();
        }));
        return reply.value_or(Json());
    }

    void advance(std::int64_t most) {
        ASSERT_TRUE(source.skip(std::min(most, source.samples_to_change()))) << source.failure();
    }
    void advance_to(std::int64_t sample) {
        while (source.next_sample() < sample) {
            advance(sample - source.next_sample());
        }
    }
};

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
    EXPECT_EQ(SimulationSource::change_at(rare, 3e-4, 1e6, 5000), 5000);  // the horn rests
    EXPECT_EQ(SimulationSource::change_at(rare, 3e-4, 1e6, 100), 301);    // it plays
    EXPECT_EQ(SimulationSource::change_at(rare, 20, 1e6, 100), 100);      // for long
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

TEST(ControlledStream, FramesKeepToTheirEpochAndNothingIsMissing) {
    Controlled stream;
    Publisher publisher("tcp://127.0.0.1:*");
    const std::string address = publisher.endpoint();
    Pipeline pipeline({.about = {{"version", "test"}},
                       .start = StreamStart::with_first_subscriber,
                       .on_overrun = OnOverrun::wait},
                      stream.source, publisher, nullptr);
    ControlServer server("tcp://127.0.0.1:*", std::nullopt, stream.control);
    std::atomic<bool> stop{false};
    std::vector<FrameHeader> headers;
    std::vector<std::int64_t> metas;
    ContinuityCheck check;
    std::thread listener([&] {
        Subscriber subscriber(address, {.receive_high_water_mark = 100'000});
        subscriber.subscribe(meta_topic);
        subscriber.subscribe(topics_of(Tap::v_out).np);
        subscriber.subscribe(end_topic);
        while (const Message* message = subscriber.receive(std::chrono::seconds(30))) {
            if (message->topic() == end_topic) {
                return;
            }
            if (message->topic() == meta_topic) {
                metas.push_back(Json::parse(message->text(0))["epoch"].get<std::int64_t>());
                continue;
            }
            const auto header = decode_header(message->text(0), message->bytes(1).size());
            ASSERT_TRUE(header);
            check.take(*header);
            EXPECT_EQ(metas.back(), static_cast<std::int64_t>(header->epoch)) << "meta follows at once";
            headers.push_back(*header);
        }
    });
    std::vector<std::int64_t> begins;
    std::thread controller([&] {
        const std::atomic<bool> never{false};
        for (int i = 0; i < 6; ++i) {
            const Json request =
                i % 3 == 2
                    ? Json{{"set", {{"chain.preload_n", 0.1 + 0.01 * i}}}}
                    : Json{{"set",
                            {{"drive.amplitude_m", 1e-6 + 1e-7 * i}, {"drive.repetition_hz", 900 + 7 * i}}}};
            const Json reply = ask_control(
                {.endpoint = server.endpoint(), .timeout_s = std::chrono::duration<double>(patience).count()},
                request, never);
            EXPECT_EQ(reply["epoch"], i + 1) << reply;
            begins.push_back(reply["applies_at_sample"]);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        stop = true;
    });
    std::optional<AllocationsOfThread> allocations;
    pipeline.run(stop, {.progress =
                            [&](const StreamMeters& meters) {
                                if (!allocations && meters.frames > 0) {
                                    allocations.emplace(simulating_thread_name);
                                }
                            },
                        .warn = [](const std::string&) {},
                        .summary = [](const StreamMeters&) { return std::string("{}"); }});
    EXPECT_EQ(allocations->so_far(), 0U);
    controller.join();
    listener.join();
    EXPECT_TRUE(check.gapless()) << check.text();
    std::int64_t epoch = 0;
    for (const FrameHeader& header : headers) {
        if (static_cast<std::int64_t>(header.epoch) != epoch) {
            EXPECT_EQ(static_cast<std::int64_t>(header.epoch), epoch + 1);
            EXPECT_EQ(static_cast<std::int64_t>(header.sample), begins.at(static_cast<std::size_t>(epoch)));
            EXPECT_EQ(header.burst_sample, 0U);
            epoch = static_cast<std::int64_t>(header.epoch);
        }
    }
    EXPECT_EQ(epoch, 6);
}

TEST(ControlServer, AnswersNonsenseAndOutlivesStrangers) {
    Controlled stream;
    ControlServer server("tcp://127.0.0.1:*", std::nullopt, stream.control);
    zmq::context_t context;
    zmq::socket_t stranger(context, zmq::socket_type::dealer);
    stranger.set(zmq::sockopt::linger, 0);
    stranger.connect(server.endpoint());
    stranger.send(zmq::buffer(std::string(100'000, 'x')), zmq::send_flags::none);
    zmq::socket_t request(context, zmq::socket_type::req);
    request.set(zmq::sockopt::linger, 0);
    request.set(zmq::sockopt::rcvtimeo, 60'000);
    request.connect(server.endpoint());
    for (const char* text : {"", "{", "[1]", "\xff", R"({"set": {}})"}) {
        request.send(zmq::buffer(std::string(text)), zmq::send_flags::none);
        zmq::message_t reply;
        ASSERT_TRUE(request.recv(reply)) << text;
        EXPECT_EQ(Json::parse(reply.to_string_view())["faults"].size(), 1U) << text;
    }
    const std::atomic<bool> never{false};
    EXPECT_EQ(ask_control({.endpoint = server.endpoint()}, {{"get", Json::array()}}, never)["epoch"], 0);
}

/// The message for a controller that gets no reply.
std::string refusal(const ControlConnection& connection) {
    const std::atomic<bool> never{false};
    try {
        return "a reply: " + ask_control(connection, {{"get", Json::array()}}, never).dump();
    } catch (const std::runtime_error& error) {
        return error.what();
    }
}

TEST(ControlServer, WhoGetsNoReplyIsToldWhy) {
    const double long_s = std::chrono::duration<double>(patience).count();
    const KeyPair server_keys = make_key_pair();
    const KeyPair own = make_key_pair();
    Controlled stream;
    ControlServer plain("tcp://127.0.0.1:*", std::nullopt, stream.control);
    Controlled other;
    ControlServer encrypted("tcp://127.0.0.1:*", CurveServer{server_keys, {make_key_pair().public_key}},
                            other.control);
    Publisher publisher("tcp://127.0.0.1:*");
    EXPECT_THAT(refusal({"tcp://127.0.0.1:9", std::nullopt, 0.2}), HasSubstr("nothing is there"));
    EXPECT_THAT(refusal({encrypted.endpoint(), CurveClient{own, server_keys.public_key}, long_s}),
                HasSubstr("it refused our key"));
    EXPECT_THAT(refusal({encrypted.endpoint(), CurveClient{own, own.public_key}, long_s}),
                HasSubstr("--server-key is not its key"));
    EXPECT_THAT(refusal({encrypted.endpoint(), std::nullopt, long_s}), HasSubstr("encrypt"));
    EXPECT_THAT(refusal({plain.endpoint(), CurveClient{own, server_keys.public_key}, long_s}),
                testing::AnyOf(HasSubstr("it does not encrypt"),
                               HasSubstr("encrypts, but not both")));  // by its greeting
    EXPECT_THAT(refusal({publisher.endpoint(), std::nullopt, long_s}),
                HasSubstr("not the control of a stream"));
}

TEST(ControlServer, AnswersThoseThatWaitWhenTheStreamEnds) {
    Controlled stream;  // nothing is simulated, so a change waits for ever
    auto server = std::make_unique<ControlServer>("tcp://127.0.0.1:*", std::nullopt, stream.control);
    zmq::context_t context;
    const auto ask = [&] {
        zmq::socket_t socket(context, zmq::socket_type::dealer);
        socket.set(zmq::sockopt::linger, 0);
        socket.set(zmq::sockopt::rcvtimeo, 60'000);
        socket.connect(server->endpoint());
        socket.send(zmq::str_buffer(R"({"set": {"drive.cycles": 4}})"), zmq::send_flags::none);
        return socket;
    };
    const auto wait_until_asked = [](zmq::socket_t& socket) {
        socket.send(zmq::str_buffer(R"({"get": ["drive.cycles"]})"), zmq::send_flags::none);
        zmq::message_t reply;  // to this, which was read later
        ASSERT_TRUE(socket.recv(reply));
        EXPECT_EQ(Json::parse(reply.to_string_view()).count("faults"), 0U);
    };
    const auto expect_refusal = [](zmq::socket_t& socket) {
        zmq::message_t reply;
        ASSERT_TRUE(socket.recv(reply));
        EXPECT_EQ(Json::parse(reply.to_string_view())["faults"][0]["message"],
                  "the stream ends at sample 1234, before this change");
    };
    zmq::socket_t one = ask();
    zmq::socket_t two = ask();
    wait_until_asked(one);
    wait_until_asked(two);
    server->end(1234);
    zmq::socket_t three = ask();
    expect_refusal(three);
    server.reset();
    expect_refusal(one);
    expect_refusal(two);
}

/// Controllers that have been answered, as many as a stream serves.
class ManyControllers {
public:
    explicit ManyControllers(const std::string& endpoint) {
        for (std::size_t i = 0; i < most_controllers; ++i) {
            zmq::socket_t& socket = sockets_.emplace_back(context_, zmq::socket_type::dealer);
            socket.set(zmq::sockopt::linger, 0);
            socket.set(zmq::sockopt::rcvtimeo, 60'000);
            socket.set(zmq::sockopt::reconnect_ivl, -1);  // who is sent away stays away
            socket.connect(endpoint);
            EXPECT_TRUE(is_answered(i));
        }
    }
    void send(std::size_t i, std::string_view text) {
        sockets_[i].send(zmq::buffer(text), zmq::send_flags::dontwait);
    }
    bool is_answered(std::size_t i, int within_ms = 60'000) {
        send(i, R"({"get": ["drive.cycles"]})");
        sockets_[i].set(zmq::sockopt::rcvtimeo, within_ms);
        zmq::message_t reply;
        return sockets_[i].recv(reply).has_value();
    }

private:
    zmq::context_t context_;
    std::vector<zmq::socket_t> sockets_;
};

TEST(ControlServer, OneMoreThanItServesTakesThePlaceOfTheOneThatWasSilentLongest) {
    Controlled stream;
    ControlServer server("tcp://127.0.0.1:*", std::nullopt, stream.control);
    ManyControllers controllers(server.endpoint());
    ASSERT_TRUE(controllers.is_answered(0));  // so the second one was silent longest
    for (int more = 0; more < 3; ++more) {
        EXPECT_THAT(refusal({.endpoint = server.endpoint()}), HasSubstr("a reply"));
    }
    EXPECT_TRUE(controllers.is_answered(0));
    EXPECT_TRUE(controllers.is_answered(most_controllers - 1));
    EXPECT_FALSE(controllers.is_answered(1, 500));
}

TEST(ControlServer, OneMoreThanItServesIsRefusedWhileAllOthersWait) {
    Controlled stream;  // nothing is simulated, so changes wait for ever
    ControlServer server("tcp://127.0.0.1:*", std::nullopt, stream.control);
    ManyControllers controllers(server.endpoint());
    for (std::size_t i = 0; i < most_controllers; ++i) {
        controllers.send(i, R"({"set": {"drive.cycles": 4}})");
        EXPECT_TRUE(controllers.is_answered(i));  // what came before has been taken, too
    }
    EXPECT_THAT(refusal({.endpoint = server.endpoint()}), HasSubstr("as many controllers as it serves (32)"));
}

TEST(ControlServer, LetsInListedControllersOnly) {
    const KeyPair server_keys = make_key_pair();
    const KeyPair controller = make_key_pair();
    const KeyPair other = make_key_pair();
    Controlled stream;
    ControlServer server("tcp://127.0.0.1:*", CurveServer{server_keys, {controller.public_key}},
                         stream.control);
    const std::atomic<bool> never{false};
    const auto ask = [&](const KeyPair& own, std::chrono::duration<double> timeout) {
        return ask_control({server.endpoint(), CurveClient{own, server_keys.public_key}, timeout.count()},
                           {{"get", Json::array()}}, never);
    };
    EXPECT_EQ(ask(controller, patience)["epoch"], 0);
    EXPECT_THROW(ask(other, std::chrono::milliseconds(500)), std::runtime_error);
}

}  // namespace
}  // namespace hertzline::test
