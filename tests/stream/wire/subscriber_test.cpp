#include "stream/wire/subscriber.hpp"

#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.hpp"
#include "tests/support/sockets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(Subscriber, RefusesEndpointsToWhichNobodyConnects) {
    EXPECT_THAT(error_of([] { Subscriber("tcp://*:5573"); }), HasSubstr("host \"*\""));
    EXPECT_THAT(error_of([] { Subscriber("tcp://127.0.0.1:*"); }), HasSubstr("port \"*\""));
}

TEST(Subscriber, SaysAtOnceThatAHostIsNotKnown) {
    Subscriber subscriber("tcp://no-such-host.invalid:5573");
    const auto refusal = subscriber.refusal();
    ASSERT_TRUE(refusal);
    EXPECT_THAT(refusal->reason,
                HasSubstr("\"tcp://no-such-host.invalid:5573\": the name of its host is not known"));
    EXPECT_FALSE(refusal->final) << "it may be known later";
    EXPECT_FALSE(subscriber.refusal()) << "said once";
}

TEST(Subscriber, MayConnectBeforeThePublisherBinds) {
    const TemporaryFolder folder;
    const std::string endpoint = "ipc://" + folder.file("s");
    Subscriber subscriber(endpoint);
    subscriber.subscribe("");
    EXPECT_EQ(subscriber.receive(0ms), nullptr);
    Publisher publisher(endpoint);
    subscriptions_until_wanted(publisher, "end");
    publisher.send("end", std::string_view("{}"));
    EXPECT_NE(subscriber.receive(patience), nullptr);
}

TEST(Subscriber, PassesOverMessagesOfTooManyParts) {
    zmq::context_t context;
    zmq::socket_t publisher(context, zmq::socket_type::xpub);
    publisher.set(zmq::sockopt::linger, 0);
    publisher.bind("tcp://127.0.0.1:*");
    Subscriber subscriber(publisher.get(zmq::sockopt::last_endpoint));
    subscriber.subscribe("");
    zmq::message_t subscription;
    ASSERT_TRUE(publisher.recv(subscription));
    const auto send = [&](int parts) {
        for (int i = 1; i <= parts; ++i) {
            publisher.send(zmq::str_buffer("part"),
                           i < parts ? zmq::send_flags::sndmore : zmq::send_flags::none);
        }
    };
    send(9);
    send(100);
    send(8);
    send(1);
    const Message* message = subscriber.receive(patience);
    ASSERT_NE(message, nullptr);
    EXPECT_EQ(message->parts(), 7u);
    EXPECT_EQ(message->text(6), "part");
    message = subscriber.receive(patience);
    ASSERT_NE(message, nullptr);
    EXPECT_EQ(message->parts(), 0u);
    EXPECT_EQ(message->topic(), "part");
}

TEST(Subscriber, WaitsNoLongerThanAskedAndLongIsNotForEver) {
    Publisher publisher("tcp://127.0.0.1:*");
    Subscriber subscriber(publisher.endpoint());
    subscriber.subscribe("end");
    EXPECT_EQ(subscriber.receive(-1ms), nullptr);
    EXPECT_EQ(subscriber.receive(1ms), nullptr);
    subscriptions_until_wanted(publisher, "end");
    publisher.send("end", std::string_view("{}"));
    EXPECT_NE(subscriber.receive(std::chrono::milliseconds::max()), nullptr);
}

}  // namespace
}  // namespace hertzline::test
