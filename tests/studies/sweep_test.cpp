#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "studies/study.hpp"
#include "tests/support/error_of.hpp"

namespace hertzline::test {

using namespace measures;
using namespace studies;
using studies::row_of;

namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Study sweep_of(const std::string& vary = "chain.preload_n=0.1..1:5") {
    auto plan = SweepPlan::make({}, {{vary}, "", "", std::nullopt});
    EXPECT_TRUE(plan);
    PointOptions options;
    options.measured = TapSet(Tap::f_last) | Tap::v_plate;
    options.columns = measures::number_columns(options.measured, false);
    options.waveform = Tap::v_out;
    options.waveform_samples = 3;
    options.waveform_channels = 2;
    options.band_from_hz = 1e3;
    return {*std::move(plan), options, {2, 3}};
}

/// Returns the journal's text of a sweep with a member changed.
std::string changed(const char* key, const Json& value) {
    auto json = Json::parse(journal_text(sweep_of()));
    json[key] = value;
    return json.dump();
}

TEST(SweepOfAJournal, IsTheSweepThatWroteIt) {
    const Study sweep = sweep_of();
    const Study again = sweep_of_journal(journal_text(sweep));
    EXPECT_EQ(journal_text(again), journal_text(sweep));
    EXPECT_EQ(again.shard, sweep.shard);
    EXPECT_EQ(again.options.measured, sweep.options.measured);
    EXPECT_EQ(again.options.waveform_samples, 3U);
    EXPECT_EQ(again.samples(), 6U);
    EXPECT_EQ(again.plan.name(4), sweep.plan.name(4));
    ASSERT_EQ(again.options.columns.size(), sweep.options.columns.size());
    for (std::size_t i = 0; i < again.options.columns.size(); ++i) {
        EXPECT_EQ(again.options.columns[i].unit, sweep.options.columns[i].unit);
        EXPECT_EQ(again.options.columns[i].whole, sweep.options.columns[i].whole);
    }
}

TEST(SweepOfAJournal, OfAnotherProgramOrPlanIsTold) {
    const Study here = sweep_of();
    EXPECT_EQ(journal_difference(journal_text(here), here), std::nullopt);
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
    EXPECT_THAT(*journal_difference(changed("format", 1), here), HasSubstr("another format"));
    EXPECT_THAT(*journal_difference(changed("maximise", "thd_r"), here), HasSubstr("one of a search"));
    EXPECT_THAT(*journal_difference(changed("shard", {1, 3}), here), HasSubstr("--shard [1,3]"));
    EXPECT_EQ(journal_difference(changed("shard", {1, 3}), here, {"shard"}), std::nullopt);
}

recordings::WrittenTable written(const Study& sweep) {
    recordings::WrittenTable table{{}, provenance_of(sweep)};
    for (const recordings::TableColumn& column : columns_of(sweep)) {
        table.columns.push_back(column.about.name);
    }
    return table;
}

TEST(TableOfAStudy, OfAnotherProgramOrPlanIsTold) {
    const Study here = sweep_of();
    EXPECT_EQ(table_difference(written(here), here), std::nullopt);
    const auto differs = [&](const Study& other) { return *table_difference(written(other), here); };
    EXPECT_THAT(differs(sweep_of("chain.preload_n=0.1..1:6")), HasSubstr("--vary"));
    Study other = sweep_of();
    for (const std::optional<Tap> waveform : {std::optional<Tap>(), std::optional(Tap::v_last)}) {
        other.options.waveform = waveform;
        EXPECT_THAT(differs(other), HasSubstr("--waveforms"));
    }
    other = sweep_of();
    other.options.columns.pop_back();
    EXPECT_THAT(differs(other), HasSubstr("another --quantity"));
    other = sweep_of();
    other.options.band_from_hz = std::nullopt;
    EXPECT_THAT(differs(other), HasSubstr("the --band-from null"));
    other = sweep_of();
    other.search = {{"maximise", "thd_r"}};
    EXPECT_THAT(differs(other), HasSubstr("one of a search"));
    recordings::WrittenTable older = written(here);
    older.provenance["version"] = "0.0.1";
    EXPECT_THAT(*table_difference(older, here), HasSubstr("the version \"0.0.1\""));
    EXPECT_THAT(*table_difference({{"t_s"}, nullptr}, here), HasSubstr("no table"));
}

TEST(SweepOfAJournal, ThatTellsOfNoneIsRefused) {
    for (const std::string& text :
         {std::string("no JSON"), std::string("[]"), std::string("{}"), changed("format", "1"),
          changed("scene", 1), changed("scene", "[chain]\nspheres = 0\n"), changed("vary", 1),
          changed("points", 1), changed("sobol", "many"), changed("maximise", "thd_r"), changed("columns", 3),
          changed("columns", {1}), changed("measured", {"v_nothing"}), changed("waveform", 7),
          changed("shard", {4, 3}), changed("shard", 1), changed("waveform_samples", "many"),
          changed("waveform_channels", 1e9)}) {
        EXPECT_THAT(error_of([&] { sweep_of_journal(text); }), Not(IsEmpty())) << text;
    }
}

TEST(SweepRow, IsItsResult) {
    const Study sweep = sweep_of();
    PointResult result;
    result.point = 3;
    result.status = PointStatus::chaotic;
    result.integrator = "taylor12";
    result.scene_hash = "0123456789abcdef";
    result.message = "one; two\nthree";
    result.numbers.assign(sweep.options.columns.size(), no_number);
    result.numbers[1] = -0.0;
    result.waveform = {1.5F, -2.5F, NAN};
    const recordings::TableRow row = row_of(sweep, result);
    EXPECT_EQ(row.cells.size(), columns_of(sweep).size());
    EXPECT_EQ(row.cells[1], recordings::Cell(std::get<double>(sweep.plan.values(3).front())));
    const PointResult again = result_of(sweep, row);
    EXPECT_EQ(again.point, 3);
    EXPECT_EQ(again.status, PointStatus::chaotic);
    EXPECT_EQ(again.integrator, result.integrator);
    EXPECT_EQ(again.scene_hash, result.scene_hash);
    EXPECT_EQ(again.message, "one; two?three");
    EXPECT_TRUE(std::isnan(again.numbers[0]));
    EXPECT_TRUE(std::signbit(again.numbers[1]));
    EXPECT_EQ(again.waveform[1], -2.5F);

    const auto cut = [&](const std::string& message) {
        result.message = message;
        return result_of(sweep, row_of(sweep, result)).message;
    };
    EXPECT_THAT(cut(std::string(1000, 'x')), SizeIs(max_message_bytes));
    EXPECT_THAT(cut(std::string(1000, 'x')), EndsWith("x ..."));
    std::string words;
    while (words.size() < 1000) {
        words += "word ";
    }
    EXPECT_THAT(cut(words), EndsWith(" word ..."));
}

}  // namespace

}  // namespace hertzline::test
