#include "studies/goal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hertzline::test {

using namespace studies;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;

PointResult result_of(PointStatus status, double value, double bounded) {
    PointResult result;
    result.status = status;
    result.numbers = {value, bounded};
    return result;
}

const std::vector<NumberColumn> judged_columns{*measures::find_column("occupied_20db_hz"),
                                               *measures::find_column("peak_v_out_m_per_s")};

TEST(Constraint, IsReadWithOrWithoutBlanks) {
    for (const char* text :
         {"peak_v_out_m_per_s >= 0.3", "peak_v_out_m_per_s>=0.3", " peak_v_out_m_per_s  >=\t3e-1 "}) {
        const auto constraint = parse_constraint(text);
        ASSERT_TRUE(constraint) << text;
        EXPECT_EQ(constraint->text(), "peak_v_out_m_per_s >= 0.3");
    }
    EXPECT_FALSE(parse_constraint("thd_r <= -1")->at_least);
    EXPECT_EQ(parse_constraint("thd_r <= -1")->bound, -1);
}

TEST(Constraint, ThatDoesNotParseIsRefused) {
    for (const char* text : {"", "thd_r", "thd_r > 3", "thd_r = 3", ">= 3", "thd_r >=", "thd_r >= x",
                             "thd_r >= 3 m", "thd_r >= nan", "thd_r >= inf", "0.3 <= thd_r"}) {
        const auto constraint = parse_constraint(text);
        ASSERT_FALSE(constraint) << text;
        EXPECT_THAT(constraint.error(), HasSubstr("allowed: \"MEASURE >= NUMBER\" or \"MEASURE <= NUMBER\""));
    }
}

TEST(Score, PutsFeasiblePointsBeforeOthersAndThoseWithoutNumbersLast) {
    const Goal goal{"occupied_20db_hz", true, {*parse_constraint("peak_v_out_m_per_s >= 0.3")}};
    const auto merit = [&](PointStatus status, double value, double bounded) {
        return merit_of(score_of(goal, judged_columns, result_of(status, value, bounded)), true);
    };
    const std::vector<double> merits{
        merit(PointStatus::ok, 2e5, 0.3), merit(PointStatus::inaccurate, 1e5, 0.4),
        merit(PointStatus::ok, -1e5, 9),  merit(PointStatus::ok, 9e5, 0.29),
        merit(PointStatus::ok, 9e9, 0.1), merit(PointStatus::chaotic, 9e9, 9),
    };
    EXPECT_TRUE(std::ranges::is_sorted(merits));
    EXPECT_EQ(std::ranges::adjacent_find(merits), merits.end());
    for (const PointStatus status : {PointStatus::refused, PointStatus::unstable}) {
        EXPECT_EQ(merit(status, no_number, no_number), merits.back());
    }
    EXPECT_EQ(merit(PointStatus::ok, no_number, 1), merits.back());
    EXPECT_EQ(merit(PointStatus::ok, 1, no_number), merits.back());
}

TEST(Score, MinimisesTheValueAndAddsUpWhatIsViolated) {
    const Goal goal{
        "occupied_20db_hz",
        false,
        {*parse_constraint("peak_v_out_m_per_s <= 2"), *parse_constraint("occupied_20db_hz >= 100")}};
    EXPECT_EQ(merit_of(score_of(goal, judged_columns, result_of(PointStatus::ok, 120, 1)), false), 120);
    EXPECT_DOUBLE_EQ(score_of(goal, judged_columns, result_of(PointStatus::ok, 75, 3)).violation, 0.25 + 0.5);
}

TEST(MeasureFaults, NameTheOptionAndAMeasureThatIsLikeIt) {
    const Goal goal{"occupied_20db", false, {*parse_constraint("thd_r >= 1")}};
    const std::vector<SearchFault> faults = measure_faults(goal, judged_columns);
    ASSERT_THAT(faults, SizeIs(2));
    EXPECT_EQ(faults[0].subject, "minimise");
    EXPECT_THAT(faults[0].text,
                AllOf(HasSubstr("found \"occupied_20db\""), HasSubstr("did you mean 'occupied_20db_hz'?")));
    EXPECT_EQ(faults[1].subject, "subject-to");
    EXPECT_THAT(faults[1].text, HasSubstr("found \"thd_r\""));
}

}  // namespace

}  // namespace hertzline::test
