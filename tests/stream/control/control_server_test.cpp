// The control of a stream over its socket: epochs in frames, nothing missing, nothing allocated; controllers of all kinds.

#include "stream/control/control_server.hpp"

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "stream/control/control_client.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/controlled.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using testing::HasSubstr;

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
        while (const Message* message = subscriber.receive(patience)) {
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
std::string refusal(const ControlConnection& connection, bool stopped = false) {
    const std::atomic<bool> stop{stopped};
    try {
        return "a reply: " + ask_control(connection, {{"get", Json::array()}}, stop).dump();
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
    EXPECT_THAT(refusal({plain.endpoint(), std::nullopt, long_s}, true),
                HasSubstr("stopped before a reply came"));
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
