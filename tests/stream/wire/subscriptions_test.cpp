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

Change deliver(Subscriptions& subscriptions, std::string_view message) {
    return subscriptions.apply(std::as_bytes(std::span(message)));
}
Change subscribe(Subscriptions& subscriptions, const std::string& prefix) {
    return deliver(subscriptions, "\1" + prefix);
}
Change cancel(Subscriptions& subscriptions, const std::string& prefix) {
    return deliver(subscriptions, std::string(1, '\0') + prefix);
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

}  // namespace
}  // namespace hertzline
