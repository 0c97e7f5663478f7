// Keys, and encryption between publishers and subscribers over real sockets.

#include "stream/wire/security/curve.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zmq.hpp>

#include "stream/wire/publisher.hpp"
#include "stream/wire/security/zap.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/sockets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline {

using namespace stream;
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

using test::eventually;
using test::patience;

TEST(Curve, KeysAreForthAndBackAndNeverTheSame) {
    const KeyPair pair = make_key_pair();
    EXPECT_NE(pair.public_key, make_key_pair().public_key);
    EXPECT_TRUE(belong_together(pair));
    EXPECT_FALSE(belong_together({make_key_pair().public_key, pair.secret_key}));
    EXPECT_EQ(z85(pair.public_key).size(), 40U);
    EXPECT_EQ(key_from_z85(z85(pair.public_key)), pair.public_key);
}

TEST(Curve, WhatIsNoKeyIsNone) {
    const std::string good = z85(make_key_pair().public_key);
    for (const std::string& text : {std::string(), good.substr(1), good + "0", good.substr(5), good + "00000",
                                    '~' + good.substr(1), '"' + good.substr(1), ' ' + good.substr(1),
                                    '\xff' + good.substr(1), std::string(1, '\0') + good.substr(1),
                                    "%nSc1" + good.substr(5)}) {  // 2^32: more than four bytes hold
        EXPECT_EQ(key_from_z85(text), std::nullopt) << text;
    }
}

class EncryptedStream : public testing::Test {
protected:
    static constexpr std::string_view topic = "meta";

    SubscriberOptions with_key(const KeyPair& own, const CurveKey& server) const {
        return {.curve = CurveClient{.own = own, .server = server}};
    }
    PublisherOptions lets_in(std::vector<CurveKey> clients) const {
        return {.curve = CurveServer{.own = server_, .clients = std::move(clients)}};
    }
    /// Expects that a subscriber receives a whole message.
    static void expect_served(Publisher& publisher, const SubscriberOptions& options) {
        Subscriber subscriber(publisher.endpoint(), options);
        subscriber.subscribe(topic);
        ASSERT_TRUE(eventually([&] { return publisher.poll_subscriptions(), publisher.wanted(topic); }));
        const std::string text(100'000, 'x');
        publisher.send(topic, text);
        const Message* message = subscriber.receive(patience);
        ASSERT_NE(message, nullptr);
        EXPECT_EQ(message->text(0), text);
        EXPECT_FALSE(subscriber.refusal());
    }
    /// Expects that a subscriber is refused with this reason, and is not among the peers.
    static Refusal refusal_of(Publisher& publisher, const SubscriberOptions& options) {
        Subscriber subscriber(publisher.endpoint(), options);
        subscriber.subscribe(topic);
        std::optional<Refusal> refusal;
        EXPECT_TRUE(eventually([&] { return (refusal = subscriber.refusal()).has_value(); }));
        publisher.poll_subscriptions();
        EXPECT_FALSE(publisher.wanted(topic));
        return refusal.value_or(Refusal{});
    }

    KeyPair server_ = make_key_pair();
    KeyPair alice_ = make_key_pair();
    KeyPair eve_ = make_key_pair();
};

TEST_F(EncryptedStream, ServesWhoIsListedOverEachTransport) {
    const test::TemporaryFolder folder;
    for (const std::string& endpoint : {std::string("tcp://127.0.0.1:*"), "ipc://" + folder.file("s")}) {
        Publisher publisher(endpoint, all_topics, lets_in({eve_.public_key, alice_.public_key}));
        EXPECT_EQ(publisher.security(), Security::curve);
        expect_served(publisher, with_key(alice_, server_.public_key));
    }
}

TEST_F(EncryptedStream, TurnsAwayWhoIsNotListed) {
    Publisher publisher("tcp://127.0.0.1:*", all_topics, lets_in({alice_.public_key}));
    const Refusal refusal = refusal_of(publisher, with_key(eve_, server_.public_key));
    EXPECT_TRUE(refusal.final);
    EXPECT_THAT(refusal.reason, HasSubstr("not on its list"));
    EXPECT_EQ(publisher.refused_clients(), 1U);
    expect_served(publisher, with_key(alice_, server_.public_key));
}

TEST_F(EncryptedStream, AListedKeyWithAnotherSecretIsOfNoUse) {
    Publisher publisher("tcp://127.0.0.1:*", all_topics, lets_in({alice_.public_key}));
    refusal_of(publisher, with_key({alice_.public_key, eve_.secret_key}, server_.public_key));
    expect_served(publisher, with_key(alice_, server_.public_key));
}

TEST_F(EncryptedStream, DoesNotTalkToWhoWantsAnotherServer) {
    Publisher publisher("tcp://127.0.0.1:*", all_topics, lets_in({alice_.public_key}));
    const Refusal refusal = refusal_of(publisher, with_key(alice_, eve_.public_key));
    EXPECT_FALSE(refusal.final);  // it hangs up without a word, and so does a publisher that ends
    EXPECT_THAT(refusal.reason, HasSubstr("closed the connection during the handshake"));
    expect_served(publisher, with_key(alice_, server_.public_key));
}

/// Returns the final reason for the refusal of a connection that only one side encrypts. ZeroMQ may retry a few times first.
Refusal last_refusal(Publisher& publisher, const SubscriberOptions& options) {
    Subscriber subscriber(publisher.endpoint(), options);
    subscriber.subscribe("");
    Refusal last;
    EXPECT_TRUE(eventually([&] { return (last = subscriber.refusal().value_or(last)).final; }));
    EXPECT_EQ(publisher.poll_subscriptions(), 0U);
    return last;
}

TEST_F(EncryptedStream, IsNotForPlainSubscribers) {
    Publisher publisher("tcp://127.0.0.1:*", all_topics, lets_in({alice_.public_key}));
    EXPECT_THAT(last_refusal(publisher, {}).reason, HasSubstr("not both"));
    EXPECT_EQ(publisher.refused_clients(), 0U);
    expect_served(publisher, with_key(alice_, server_.public_key));
}

TEST_F(EncryptedStream, IsNotSoughtAtAPlainPublisher) {
    Publisher publisher("tcp://127.0.0.1:*");
    EXPECT_EQ(publisher.security(), Security::none);
    EXPECT_THAT(last_refusal(publisher, with_key(alice_, server_.public_key)).reason, HasSubstr("not both"));
    expect_served(publisher, {});
}

/// A publisher's socket alone, so that a test can remove its handler.
TEST_F(EncryptedStream, WithoutItsHandlerLetsNobodyIn) {
    zmq::context_t context;
    std::optional<ZapHandler> handler(std::in_place, context, std::vector{alice_.public_key});
    zmq::socket_t socket(context, zmq::socket_type::xpub);
    socket.set(zmq::sockopt::linger, 0);
    encrypt_as_server(socket, server_);
    socket.bind("tcp://127.0.0.1:*");
    const std::string endpoint = socket.get(zmq::sockopt::last_endpoint);
    zmq::message_t subscription;

    Subscriber first(endpoint, with_key(alice_, server_.public_key));
    first.subscribe("a");
    socket.set(zmq::sockopt::rcvtimeo, 20'000);
    ASSERT_TRUE(socket.recv(subscription));
    EXPECT_EQ(subscription.to_string(), "\1a");

    handler.reset();
    Subscriber second(endpoint, with_key(alice_, server_.public_key));
    second.subscribe("b");
    int refusals = 0;
    EXPECT_TRUE(eventually([&] { return (refusals += second.refusal().has_value() ? 1 : 0) == 3; }));
    EXPECT_FALSE(socket.recv(subscription, zmq::recv_flags::dontwait));
}

}  // namespace
}  // namespace hertzline
