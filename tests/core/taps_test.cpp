#include "core/taps.hpp"

#include <atomic>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hertzline {
namespace {

TEST(Taps, TopicsAreTheStreamsNameAndTheFormat) {
    for (const Tap tap : all_taps) {
        const TapNames names = names_of(tap);
        EXPECT_EQ(names.raw_topic, std::string(names.name) + "/raw");
        EXPECT_EQ(names.np_topic, std::string(names.name) + "/np");
        EXPECT_EQ(names.unit, "m/s");
        EXPECT_EQ(tap_named(names.name), tap);
    }
    EXPECT_EQ(names_of(Tap::v_out).name, "v_out");
    EXPECT_EQ(names_of(Tap::v_last).name, "v_last");
    EXPECT_EQ(names_of(Tap::v_plate).name, "v_plate");
    EXPECT_EQ(names_of(Tap::v_chain).name, "v_chain");
}

TEST(Taps, UnknownNamesAreNoTap) {
    for (const char* name : {"", "v", "v_out/raw", "V_OUT", "meta"}) {
        EXPECT_FALSE(tap_named(name)) << name;
    }
}

TEST(Taps, EveryTopicIsListedOnce) {
    const std::set<std::string_view> topics(all_topics.begin(), all_topics.end());
    EXPECT_EQ(topics.size(), 11u);
    for (const char* topic : {"v_out/raw", "v_chain/np", "meta", "meters", "end"}) {
        EXPECT_TRUE(topics.contains(topic)) << topic;
    }
}

TEST(Taps, OnlyAPlateHasAPlateVelocity) {
    EXPECT_TRUE(taps_of(EndKind::plate).contains(Tap::v_plate));
    EXPECT_EQ(taps_of(EndKind::plate).size(), 4u);
    for (const EndKind end : {EndKind::wall, EndKind::free}) {
        EXPECT_EQ(taps_of(end), taps_of(EndKind::plate) - Tap::v_plate);
        EXPECT_EQ(taps_of(end).size(), 3u);
    }
}

TEST(Taps, TheChainHasAChannelPerSphere) {
    Spheres chain;
    chain.spheres = 17;
    EXPECT_EQ(channels_of(Tap::v_chain, chain), 17u);
    for (const Tap tap : {Tap::v_out, Tap::v_last, Tap::v_plate}) {
        EXPECT_EQ(channels_of(tap, chain), 1u);
    }
}

TEST(TapSet, BehavesAsASet) {
    TapSet set;
    EXPECT_TRUE(set.empty());
    set |= Tap::v_chain;
    set |= Tap::v_out;
    set |= Tap::v_out;
    EXPECT_EQ(set.size(), 2u);
    EXPECT_TRUE(set.contains(Tap::v_out));
    EXPECT_FALSE(set.contains(Tap::v_last));
    EXPECT_EQ(set - Tap::v_out, TapSet(Tap::v_chain));
    EXPECT_EQ(set & Tap::v_out, TapSet(Tap::v_out));
    EXPECT_TRUE((set & Tap::v_plate).empty());
}

TEST(TapSet, CanBeSharedBetweenThreadsWithoutALock) {
    EXPECT_TRUE(std::atomic<TapSet>::is_always_lock_free);
    std::atomic<TapSet> shared{TapSet()};
    shared = TapSet(Tap::v_last);
    EXPECT_EQ(shared.load(), TapSet(Tap::v_last));
}

TEST(TapSet, IteratesInTheOrderOfTheEnumeration) {
    std::vector<Tap> seen;
    for (const Tap tap : TapSet(Tap::v_chain) | Tap::v_out | Tap::v_plate) {
        seen.push_back(tap);
    }
    EXPECT_EQ(seen, (std::vector{Tap::v_out, Tap::v_plate, Tap::v_chain}));
    EXPECT_EQ(TapSet().begin(), TapSet().end());
}

}  // namespace
}  // namespace hertzline
