#pragma once
// Bounded waiting for messages over real sockets. The bound is generous, because only a failing test takes so long.

#include <chrono>
#include <cstddef>
#include <string_view>
#include <thread>

#include <gtest/gtest.h>

#include "stream/wire/publisher.hpp"

namespace hertzline::test {

/// Waiting time of a test that fails.
inline constexpr std::chrono::seconds patience{120};

/// Tries until the condition holds. Returns false when it does not within `patience`.
template <class Condition>
bool eventually(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

/// Waits until the topic is wanted. Returns the number of subscriptions received.
inline std::size_t subscriptions_until_wanted(stream::Publisher& publisher, std::string_view topic) {
    std::size_t count = 0;
    EXPECT_TRUE(eventually([&] {
        count += publisher.poll_subscriptions();
        return publisher.wanted(topic);
    }));
    return count;
}

}  // namespace hertzline::test
