#include "stream/wire/subscriptions.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "stream/wire/topics.hpp"
#include "tests/support/allocation_count.hpp"

namespace hertzline {

using namespace stream;
namespace {

using Change = Subscriptions::Change;

Change deliver(Subscriptions& subscriptions, std::string_view message, int peer = 1) {
    return subscriptions.apply(peer, std::as_bytes(std::span(message)));
}
Change subscribe(Subscriptions& subscriptions, const std::string& prefix, int peer = 1) {
    return deliver(subscriptions, "\1" + prefix, peer);
}
Change cancel(Subscriptions& subscriptions, const std::string& prefix, int peer = 1) {
    return deliver(subscriptions, std::string(1, '\0') + prefix, peer);
}

TEST(Subscriptions, NothingIsWantedAtFirst) {
    const Subscriptions subscriptions(all_topics);
    for (const std::string_view topic : all_topics) {
        EXPECT_FALSE(subscriptions.wanted(topic)) << topic;
    }
}

TEST(Subscriptions, APrefixWantsTheTopicsThatBeginWithIt) {
    Subscriptions subscriptions(all_topics);
    EXPECT_EQ(subscribe(subscriptions, "v_out"), Change::subscribed);
    for (const std::string_view topic : all_topics) {
        EXPECT_EQ(subscriptions.wanted(topic), topic.starts_with("v_out")) << topic;
    }
    EXPECT_EQ(cancel(subscriptions, "v_out"), Change::unsubscribed);
    EXPECT_FALSE(subscriptions.wanted("v_out/raw"));
}

TEST(Subscriptions, TheEmptyPrefixWantsEverything) {
    Subscriptions subscriptions(all_topics);
    EXPECT_EQ(subscribe(subscriptions, ""), Change::subscribed);
    for (const std::string_view topic : all_topics) {
        EXPECT_TRUE(subscriptions.wanted(topic)) << topic;
    }
}

TEST(Subscriptions, ATopicIsWantedUntilItsLastPrefixIsCancelled) {
    Subscriptions subscriptions(all_topics);
    subscribe(subscriptions, "");
    subscribe(subscriptions, "v_out/raw");
    subscribe(subscriptions, "v_out/");
    cancel(subscriptions, "");
    cancel(subscriptions, "v_out/raw");
    EXPECT_TRUE(subscriptions.wanted("v_out/raw"));
    EXPECT_FALSE(subscriptions.wanted("meta"));
    cancel(subscriptions, "v_out/");
    EXPECT_FALSE(subscriptions.wanted("v_out/raw"));
}

TEST(Subscriptions, WhatIsLongerThanATopicWantsNothing) {
    Subscriptions subscriptions(all_topics);
    EXPECT_EQ(subscribe(subscriptions, "meta/"), Change::foreign);
    EXPECT_EQ(subscribe(subscriptions, std::string(255, 'm')), Change::foreign);
    EXPECT_FALSE(subscriptions.wanted("meta"));
    EXPECT_EQ(cancel(subscriptions, "never subscribed"), Change::foreign);
}

TEST(Subscriptions, TheLongestTopicsHaveABitForEveryPrefix) {
    const std::string topic(63, 't');
    const std::array<std::string_view, 1> topics{topic};
    Subscriptions subscriptions(topics);
    EXPECT_EQ(subscribe(subscriptions, topic), Change::subscribed);
    EXPECT_TRUE(subscriptions.wanted(topic));
    cancel(subscriptions, topic);
    EXPECT_FALSE(subscriptions.wanted(topic));
    const std::string longer(64, 't');
    const std::array<std::string_view, 1> too_long{longer};
    EXPECT_THROW(Subscriptions{too_long}, std::invalid_argument);
}

TEST(Subscriptions, MalformedMessagesChangeNothing) {
    Subscriptions subscriptions(all_topics);
    subscribe(subscriptions, "meta");
    for (const char* message : {"", "\2meta", "meta", "\xff"}) {
        EXPECT_EQ(deliver(subscriptions, message), Change::malformed);
    }
    EXPECT_TRUE(subscriptions.wanted("meta"));
    EXPECT_FALSE(subscriptions.wanted("end"));
}

TEST(Subscriptions, AFloodOfPrefixesTakesNoMemoryAndCrowdsOutNobody) {
    Subscriptions subscriptions(all_topics);
    std::string message("\1v_out/raw????????");
    const std::string real = "\1v_last/np";
    subscribe(subscriptions, "meta");  // from here on the peer is known
    const std::size_t before = test::allocations();
    for (unsigned i = 0; i < 100'000; ++i) {
        for (unsigned k = 0; k < 8; ++k) {
            message[10 + k] = static_cast<char>('a' + (i >> (2 * k)) % 4);
        }
        deliver(subscriptions, message);
    }
    EXPECT_EQ(deliver(subscriptions, real), Change::subscribed);
    EXPECT_EQ(test::allocations(), before);
    EXPECT_TRUE(subscriptions.wanted("v_last/np"));
    EXPECT_FALSE(subscriptions.wanted("v_out/raw"));
}

TEST(Subscriptions, ATopicIsWantedUntilItsLastPeerCancelsOrLeaves) {
    Subscriptions subscriptions(all_topics);
    for (const int peer : {1, 2, 3}) {
        subscribe(subscriptions, "v_out", peer);
    }
    subscribe(subscriptions, "", 3);
    cancel(subscriptions, "v_out", 1);
    subscriptions.forget(2);
    subscriptions.forget(7);
    EXPECT_TRUE(subscriptions.wanted("v_out/np"));
    cancel(subscriptions, "", 3);
    EXPECT_FALSE(subscriptions.wanted("meta"));
    EXPECT_TRUE(subscriptions.wanted("v_out/np"));
    subscriptions.forget(3);
    EXPECT_FALSE(subscriptions.wanted("v_out/np"));
}

/// Sends so many messages, of which `frozen` takes none.
void send(Subscriptions& subscriptions, std::string_view topic, int messages, int frozen) {
    const auto takes_nothing = [frozen](int peer) { return peer == frozen; };
    for (int i = 0; i < messages; ++i) {
        subscriptions.note_sent(topic);
        subscriptions.judge(takes_nothing, 10);
    }
}

TEST(Subscriptions, WhoTakesNothingWantsNothingOnceItsQueueIsFull) {
    Subscriptions subscriptions(all_topics);
    subscribe(subscriptions, "", 1);
    subscribe(subscriptions, "v_out", 2);
    send(subscriptions, "v_chain/np", 9, 1);
    EXPECT_TRUE(subscriptions.taken("v_chain/np")) << "there is room for one more";
    send(subscriptions, "v_out/np", 1, 1);
    EXPECT_FALSE(subscriptions.taken("v_chain/np"));
    EXPECT_TRUE(subscriptions.wanted("v_chain/np")) << "it has a subscriber still";
    EXPECT_TRUE(subscriptions.taken("v_out/np")) << "another one takes it";
    subscriptions.forget(2);
    EXPECT_FALSE(subscriptions.taken("v_out/np"));
}

TEST(Subscriptions, WhoTakesSomethingAgainOrAsksForSomethingCounts) {
    Subscriptions subscriptions(all_topics);
    const auto freeze = [&] { send(subscriptions, "v_chain/np", 20, 1); };
    subscribe(subscriptions, "v_chain");
    freeze();
    EXPECT_FALSE(subscriptions.taken("v_chain/np"));
    send(subscriptions, "v_chain/np", 1, /*frozen=*/0);
    EXPECT_TRUE(subscriptions.taken("v_chain/np"));
    freeze();
    EXPECT_FALSE(subscriptions.taken("v_chain/np"));
    subscribe(subscriptions, "meta");
    EXPECT_TRUE(subscriptions.taken("v_chain/np"));
    EXPECT_TRUE(subscriptions.taken("meta"));
}

TEST(Subscriptions, ATopicThatIsNotSubscribedToFillsNoQueue) {
    Subscriptions subscriptions(all_topics);
    subscribe(subscriptions, "v_out");
    send(subscriptions, "v_chain/np", 100, 1);
    EXPECT_TRUE(subscriptions.taken("v_out/np"));
}

}  // namespace
}  // namespace hertzline
