#include "studies/sweep/sweep.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "tests/support/error_of.hpp"

namespace hertzline::test {

using namespace measures;
using namespace studies;

namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Sweep sweep_of(const std::string& vary = "chain.preload_n=0.1..1:5") {
    auto plan = SweepPlan::make({}, {{vary}, "", "", std::nullopt});
    EXPECT_TRUE(plan);
    PointDemand demand;
    demand.measured = TapSet(Tap::f_last) | Tap::v_plate;
    demand.columns = measures::number_columns(demand.measured, false);
    demand.waveform = Tap::v_out;
    demand.waveform_samples = 3;
    demand.band_from_hz = 1e3;
    return {*std::move(plan), demand, {2, 3}};
}

/// The journal's text of a sweep with a member changed.
std::string changed(const char* key, const Json& value) {
    auto json = Json::parse(journal_text(sweep_of()));
    json[key] = value;
    return json.dump();
}

TEST(SweepOfAJournal, IsTheSweepThatWroteIt) {
    const Sweep sweep = sweep_of();
    const Sweep again = sweep_of_journal(journal_text(sweep));
    EXPECT_EQ(journal_text(again), journal_text(sweep));
    EXPECT_EQ(again.shard, sweep.shard);
    EXPECT_EQ(again.demand.measured, sweep.demand.measured);
    EXPECT_EQ(again.demand.waveform_samples, 3U);
    EXPECT_EQ(again.plan.name(4), sweep.plan.name(4));
    ASSERT_EQ(again.demand.columns.size(), sweep.demand.columns.size());
    for (std::size_t i = 0; i < again.demand.columns.size(); ++i) {
        EXPECT_EQ(again.demand.columns[i].unit, sweep.demand.columns[i].unit);
        EXPECT_EQ(again.demand.columns[i].whole, sweep.demand.columns[i].whole);
    }
}

TEST(SweepOfAJournal, OfAnotherProgramOrPlanIsTold) {
    const std::string here = journal_text(sweep_of());
    EXPECT_EQ(journal_difference(here, here), std::nullopt);
    EXPECT_EQ(
        journal_difference(changed("simd_target", "AVX9"), here),
        std::string("the instruction set \"AVX9\" where this sweep has \"") + kernels::kernel_target() + '"');
    EXPECT_THAT(*journal_difference(changed("version", "0.0.1"), here), HasSubstr("the version \"0.0.1\""));
    EXPECT_THAT(*journal_difference(changed("git_hash", "abc"), here), HasSubstr("the commit \"abc\""));
    EXPECT_THAT(*journal_difference(changed("compiler", "cc"), here), HasSubstr("the compiler \"cc\""));
    EXPECT_THAT(*journal_difference(changed("columns", {"thd_r"}), here), HasSubstr("another --quantity"));
    EXPECT_THAT(*journal_difference(changed("band_from_hz", nullptr), here),
                HasSubstr("the --band-from null"));
    EXPECT_THAT(*journal_difference(journal_text(sweep_of("chain.preload_n=0.1..1:6")), here),
                HasSubstr("--vary"));
    EXPECT_THAT(*journal_difference(changed("format", 2), here), HasSubstr("another format"));
    EXPECT_THAT(*journal_difference(changed("shard", {1, 3}), here), HasSubstr("--shard [1,3]"));
    EXPECT_EQ(journal_difference(changed("shard", {1, 3}), here, true), std::nullopt);
}

TEST(SweepOfAJournal, ThatTellsOfNoneIsRefused) {
    for (const std::string& text :
         {std::string("no JSON"), std::string("[]"), std::string("{}"), changed("format", "1"),
          changed("plan", 1),
          changed("plan", {{"scene", "[chain]\nspheres = 0\n"},
                           {"vary", {"chain.preload_n=1,2"}},
                           {"points", ""},
                           {"sobol", nullptr}}),
          changed("columns", 3), changed("columns", {1}), changed("measured", {"v_nothing"}),
          changed("waveform", 7), changed("shard", {4, 3}), changed("shard", 1),
          changed("waveform_samples", "many")}) {
        EXPECT_THAT(error_of([&] { sweep_of_journal(text); }), Not(IsEmpty())) << text;
    }
}

TEST(SweepRow, SurvivesTheJournal) {
    const Sweep sweep = sweep_of();
    PointResult result;
    result.point = 3;
    result.status = PointStatus::chaotic;
    result.integrator = "taylor12";
    result.scene_hash = "0123456789abcdef";
    result.message = "one; two\nthree";
    result.numbers.assign(sweep.demand.columns.size(), no_number);
    result.numbers[1] = -0.0;
    result.numbers[2] = 1e-310;
    result.waveform = {1.5F, -2.5F, NAN};
    std::vector<std::byte> payload(payload_bytes(sweep.demand));
    encode(result, payload);
    const PointResult again = decode(3, PointStatus::chaotic, sweep.demand, payload);
    EXPECT_EQ(again.integrator, result.integrator);
    EXPECT_EQ(again.scene_hash, result.scene_hash);
    EXPECT_EQ(again.message, "one; two?three");
    EXPECT_TRUE(std::isnan(again.numbers[0]));
    EXPECT_TRUE(std::signbit(again.numbers[1]));
    EXPECT_EQ(again.numbers[2], 1e-310);
    EXPECT_EQ(again.waveform[1], -2.5F);
    EXPECT_TRUE(std::isnan(again.waveform[2]));

    result.message = std::string(1000, 'x');
    encode(result, payload);
    const std::string cut = decode(3, PointStatus::ok, sweep.demand, payload).message;
    EXPECT_THAT(cut, SizeIs(max_message_bytes));
    EXPECT_THAT(cut, EndsWith("x ..."));

    result.message.clear();
    while (result.message.size() < 1000) {
        result.message += "word ";
    }
    encode(result, payload);
    EXPECT_THAT(decode(3, PointStatus::ok, sweep.demand, payload).message, EndsWith(" word ..."));
}

}  // namespace

}  // namespace hertzline::test
