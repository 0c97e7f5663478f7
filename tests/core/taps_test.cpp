#include "hertzline/taps.hpp"

#include <atomic>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/ends.hpp"

namespace hertzline {
namespace {

using test::scene_with_end;

TEST(Taps, EachHasARowOfItsOwn) {
    std::set<std::string_view> names;
    std::set<std::string_view> columns;
    for (const Tap tap : all_taps) {
        const TapRow& row = row_of(tap);
        EXPECT_EQ(row.tap, tap);
        EXPECT_EQ(tap_named(row.name), tap);
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_TRUE(columns.insert(row.column).second) << row.column;
        EXPECT_EQ(row.channels != Channels::one && row.channels != Channels::per_element,
                  row.column.find('#') != std::string_view::npos)
            << row.name;
    }
    EXPECT_EQ(all_taps.size(), tap_count);
}

// Scripts of others rely on these.
TEST(Taps, KeepTheirNamesUnitsAndColumns) {
    EXPECT_EQ(row_of(Tap::v_out).column, "v_out_m_per_s");
    EXPECT_EQ(row_of(Tap::v_last).column, "v_last_m_per_s");
    EXPECT_EQ(row_of(Tap::v_plate).column, "v_plate_m_per_s");
    EXPECT_EQ(row_of(Tap::v_chain).column, "v#_m_per_s");
    EXPECT_EQ(row_of(Tap::x_chain).column, "x#_m");
    EXPECT_EQ(row_of(Tap::f_chain).column, "f#_n");
    EXPECT_EQ(row_of(Tap::p_points).column, "p_#_pa");
    EXPECT_EQ(row_of(Tap::v_out).unit, "m/s");
    EXPECT_EQ(row_of(Tap::x_chain).unit, "m");
}

TEST(Taps, ARecordingHoldsTheSameByDefaultWhateverTapsThereAre) {
    EXPECT_EQ(recorded_taps(scene_with_end(EndKind::plate)), TapSet(Tap::v_last) | Tap::v_plate | Tap::v_out);
    EXPECT_EQ(recorded_taps(scene_with_end(EndKind::wall)), TapSet(Tap::v_last));
    EXPECT_EQ(recorded_taps(scene_with_end(EndKind::free)), TapSet(Tap::v_last));
}

TEST(Taps, UnknownNamesAreNoTap) {
    for (const char* name : {"", "v", "v_out/raw", "V_OUT", "meta"}) {
        EXPECT_FALSE(tap_named(name)) << name;
    }
}

TEST(Taps, OnlyAPlateHasAPlateVelocity) {
    EXPECT_TRUE(taps_of(scene_with_end(EndKind::plate)).contains(Tap::v_plate));
    for (const EndKind end : {EndKind::wall, EndKind::free}) {
        EXPECT_FALSE(taps_of(scene_with_end(end)).contains(Tap::v_plate));
        EXPECT_TRUE(taps_of(scene_with_end(end)).contains(Tap::v_out));
        EXPECT_TRUE(taps_of(scene_with_end(end)).contains(Tap::v_chain));
    }
}

TEST(Taps, HaveAChannelPerSphereContactOrPoint) {
    constexpr ChannelCounts counts{.spheres = 17, .points = 4};
    EXPECT_EQ(channels_of(Tap::v_chain, counts), 17U);
    EXPECT_EQ(channels_of(Tap::f_chain, counts), 18U) << "one of them is the end's";
    EXPECT_EQ(channels_of(Tap::p_points, counts), 4U);
    EXPECT_EQ(counts_of(Tap::f_chain, 18).spheres, 17U);
    EXPECT_EQ(counts_of(Tap::v_chain, 17).spheres, 17U);
    EXPECT_EQ(counts_of(Tap::p_points, 4).points, 4U);
    for (const Tap tap : {Tap::v_out, Tap::v_last, Tap::v_plate}) {
        EXPECT_EQ(channels_of(tap, counts), 1U);
    }
    EXPECT_EQ(channels_of(TapSet(Tap::v_chain) | Tap::x_chain | Tap::v_out | Tap::p_points, counts),
              2 * 17 + 1 + 4);
}

TEST(Taps, OnlyAModalPlateWithPointsHasPressuresThere) {
    Scene scene;
    scene.output.points_m = {{0, 0, 0.01}};
    EXPECT_FALSE(taps_of(scene).contains(Tap::p_points));
    scene.end.model = PlateModel::modal;
    EXPECT_TRUE(taps_of(scene).contains(Tap::p_points));
    EXPECT_TRUE(recorded_taps(scene).contains(Tap::p_points));
    scene.output.points_m.clear();
    EXPECT_FALSE(taps_of(scene).contains(Tap::p_points));
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
