#include "studies/point.hpp"

#include <algorithm>
#include <atomic>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"

namespace hertzline::test {

using namespace studies;

namespace {

using testing::HasSubstr;
using testing::Not;

/// Returns the row of the shipped scene whose band begins where it is looked for, with those columns.
PointResult row_with(std::vector<NumberColumn> columns) {
    static const std::atomic<bool> never{false};
    PointOptions options;
    options.columns = std::move(columns);
    Scene scene = read_scene("paper-vitreous-carbon");
    scene.chain.preload_n = 0.01;
    return *PointRunner(options, never).run(0, scene);
}

TEST(Point, HasSpectraAndTheirWarningsWhereANumberOfASpectrumIsAskedFor) {
    const NumberColumn peak = *measures::find_column("peak_v_out_m_per_s");
    const PointResult with = row_with({peak, *measures::find_column("thd_r")});
    const PointResult without = row_with({peak});
    EXPECT_EQ(without.numbers[0], with.numbers[0]);
    EXPECT_GT(with.numbers[1], 0);
    EXPECT_THAT(with.message, HasSubstr("-20 dB band"));
    EXPECT_THAT(without.message, Not(HasSubstr("-20 dB band")));
}

TEST(Point, HasTheNumbersOfItsRunInEachColumn) {
    const std::vector<NumberColumn> columns = measures::number_columns({}, false);
    const PointResult row = row_with(columns);
    const auto number = [&](std::string_view name) {
        const auto column = std::ranges::find(columns, name, &NumberColumn::name);
        return row.numbers[static_cast<std::size_t>(column - columns.begin())];
    };
    EXPECT_EQ(number("harmonics_db_1") * number("harmonics_db_2"), 0);  // the largest is the reference
    EXPECT_NE(number("harmonics_db_3"), number("harmonics_db_4"));
    EXPECT_NE(number("harmonics_db_3"), number("switching_db_3"));
    EXPECT_EQ(number("fundamental_hz"), 73e3);
}

}  // namespace

}  // namespace hertzline::test
