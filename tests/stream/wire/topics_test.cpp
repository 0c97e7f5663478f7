#include "stream/wire/topics.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace hertzline::test {

using namespace stream;

namespace {

TEST(Topics, AreTheTapsNameAndTheFormat) {
    for (const Tap tap : all_taps) {
        const std::string name(row_of(tap).name);
        EXPECT_EQ(std::string_view(topics_of(tap).raw), name + "/raw");
        EXPECT_EQ(std::string_view(topics_of(tap).np), name + "/np");
    }
}

TEST(Topics, AreAllListedOnce) {
    const std::set<std::string_view> topics(all_topics.begin(), all_topics.end());
    EXPECT_EQ(topics.size(), 2 * tap_count + 3);
    for (const char* topic : {"v_out/raw", "v_chain/np", "meta", "meters", "end"}) {
        EXPECT_TRUE(topics.contains(topic)) << topic;
    }
}

}  // namespace
}  // namespace hertzline::test
