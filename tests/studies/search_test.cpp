#include "studies/search.hpp"

#include <atomic>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/plan.hpp"
#include "studies/point.hpp"

namespace hertzline::test {

using namespace studies;

namespace {

SearchSpace space_of(const std::vector<std::string>& vary) {
    const auto plan = SweepPlan::make({}, {vary, "", "", 1});
    EXPECT_TRUE(plan);
    return SearchSpace(plan->axes());
}

double number(const SceneValue& value) {
    return std::get<double>(value);
}

/// The result of a search, and all its evaluations.
struct Found {
    SearchResult result;
    Evaluations evaluations;
    std::vector<std::size_t> batches;  ///< sizes
};

template <class ScoreOf>
Found found_in(const SearchSpace& space, std::int64_t budget, std::uint64_t seed, ScoreOf score_of,
               bool maximise = true) {
    std::vector<std::size_t> batches;
    Evaluations evaluations(maximise, budget, [&](std::span<const std::vector<SceneValue>> points) {
        std::vector<Score> scores;
        for (const std::vector<SceneValue>& values : points) {
            scores.push_back(score_of(values));
        }
        batches.push_back(points.size());
        return std::optional(scores);
    });
    SearchResult result = search(space, evaluations, seed);
    return {std::move(result), std::move(evaluations), std::move(batches)};
}

Score feasible(double value) {
    return {true, true, value, 0};
}

const std::vector<std::string> two_ranges{"end.thickness_m=0.1e-3..2e-3:log", "chain.preload_n=0.01..2:log"};

/// Returns the score of two hills: the higher one has its top at 0.5 mm and 0.2 N.
Score hills(const std::vector<SceneValue>& values) {
    const auto hill = [&](double thickness, double preload) {
        const double x = std::log(number(values[0]) / thickness);
        const double y = std::log(number(values[1]) / preload);
        return std::exp(-x * x - y * y);
    };
    return feasible(2 * hill(0.5e-3, 0.2) + hill(1.5e-3, 1.5));
}

TEST(Search, FindsTheTopOfTwoHills) {
    const SearchSpace space = space_of(two_ranges);
    const Found found = found_in(space, 2000, 1, hills);
    const auto& best = found.evaluations[found.result.best.centre];
    EXPECT_NEAR(number(best.values[0]), 0.5e-3, 0.02e-3);
    EXPECT_NEAR(number(best.values[1]), 0.2, 0.01);
    EXPECT_EQ(found.result.best.near.size(), 4U);
    EXPECT_EQ(found.result.best.far.size(), 4U);
    EXPECT_GT(found.evaluations[found.result.best.worst(found.evaluations)].score.value, 1.99);
    ASSERT_FALSE(found.result.others.empty());
    EXPECT_NEAR(found.evaluations[found.result.others[0].centre].score.value, 1, 0.1);
    EXPECT_LE(found.evaluations.size(), 2000);
}

TEST(Search, GoesTheSameWayForASeedAndAnotherForAnother) {
    const SearchSpace space = space_of(two_ranges);
    const auto points = [&](std::uint64_t seed) {
        const Found found = found_in(space, 150, seed, hills);
        std::vector<std::vector<SceneValue>> looked_at;
        for (const auto& evaluation : found.evaluations.all()) {
            looked_at.push_back(evaluation.values);
        }
        return looked_at;
    };
    EXPECT_EQ(points(7), points(7));
    EXPECT_NE(points(7), points(8));
}

TEST(Search, AsksInBatches) {
    const Found found = found_in(space_of(two_ranges), 2000, 1, hills);
    const auto largest = std::ranges::max(found.batches);
    EXPECT_GT(largest, 70U);  // a level's sample
    EXPECT_LT(found.batches.size(), static_cast<std::size_t>(found.evaluations.size()) / 3);
}

TEST(Search, KeepsToTheConstraintsAndTheRanges) {
    const SearchSpace space = space_of(two_ranges);
    const Found found = found_in(space, 300, 1, [](const std::vector<SceneValue>& values) {
        const double preload = number(values[1]);  // the larger the better, up to 0.05
        return Score{true, preload <= 0.05, preload, std::max(0.0, preload / 0.05 - 1)};
    });
    for (const auto& evaluation : found.evaluations.all()) {
        EXPECT_GE(number(evaluation.values[0]), 0.1e-3);
        EXPECT_LE(number(evaluation.values[0]), 2e-3);
    }
    const auto& best = found.evaluations[found.result.best.centre];
    EXPECT_TRUE(best.score.feasible);
    EXPECT_NEAR(best.score.value, 0.05, 0.001);
    // one per cent more breaks the bound, and the search says so
    EXPECT_FALSE(found.evaluations[found.result.best.worst(found.evaluations)].score.feasible);
}

TEST(Search, MinimisesOverWordsAndWholeNumbers) {
    const SearchSpace space = space_of({"end.material=pyrex,acrylic,steel", "chain.spheres=3..40"});
    const Found found = found_in(
        space, 100, 1,
        [](const std::vector<SceneValue>& values) {
            const auto spheres = static_cast<double>(std::get<std::int64_t>(values[1]));
            return feasible(std::abs(spheres - 17) + (std::get<std::string>(values[0]) == "acrylic" ? 0 : 5));
        },
        false);
    const auto& best = found.evaluations[found.result.best.centre];
    EXPECT_EQ(std::get<std::string>(best.values[0]), "acrylic");
    EXPECT_EQ(std::get<std::int64_t>(best.values[1]), 17);
    EXPECT_TRUE(found.result.best.near.empty());
    EXPECT_EQ(found.result.best.far.size(), 2U);
}

TEST(Search, EndsWhenThereIsNothingLeft) {
    const Found found = found_in(space_of({"end.material=pyrex,acrylic", "chain.spheres=3..6"}), 1000, 1,
                                 [](const std::vector<SceneValue>&) { return feasible(1); });
    EXPECT_LE(found.evaluations.size(), 8);
    EXPECT_NE(found.result.best.centre, Evaluations::none);
}

TEST(Search, WithoutAFeasibleOrUsablePointHasNoBest) {
    const SearchSpace space = space_of(two_ranges);
    for (const Score& score : {Score{true, false, 1, 0.5}, Score{}}) {
        const Found found = found_in(space, 200, 1, [&](const std::vector<SceneValue>&) { return score; });
        EXPECT_EQ(found.result.best.centre, Evaluations::none);
        EXPECT_GT(found.evaluations.size(), 150);
    }
}

TEST(Search, UsesTheSmallestBudgetAndNoMore) {
    const SearchSpace space = space_of(two_ranges);
    const std::int64_t fewest = fewest_evaluations(space);
    const Found found = found_in(space, fewest, 1, hills);
    EXPECT_LE(found.evaluations.size(), fewest);
    EXPECT_EQ(found.result.best.centre, found.evaluations.best());
}

TEST(Search, TheBestIsTheBestOfAllThatWasLookedAt) {
    // so rugged that a neighbour of the best is often better
    const auto rugged = [](const std::vector<SceneValue>& values) {
        return feasible(std::sin(1e7 * number(values[0])) + std::sin(1e4 * number(values[1])));
    };
    const SearchSpace space = space_of(two_ranges);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        for (const std::int64_t budget : {fewest_evaluations(space), std::int64_t{300}}) {
            const Found found = found_in(space, budget, seed, rugged);
            EXPECT_EQ(found.result.best.centre, found.evaluations.best()) << seed;
        }
    }
}

TEST(Search, StopsWhenItIsStopped) {
    const SearchSpace space = space_of(two_ranges);
    int batches = 0;
    Evaluations evaluations(true, 1000, [&](std::span<const std::vector<SceneValue>> points) {
        return ++batches > 3 ? std::nullopt : std::optional(std::vector<Score>(points.size(), feasible(1)));
    });
    search(space, evaluations, 1);
    EXPECT_TRUE(evaluations.stopped());
    EXPECT_EQ(batches, 4);
}

/// The paper's device in a short run, scored by a goal.
class Device {
public:
    explicit Device(const Goal& goal)
        : goal_(goal),
          options_{{}, std::nullopt, measures::number_columns({}, false), std::nullopt, 0},
          runner_(options_, stop_) {
        scene_.output.duration_s = 2e-4;
        scene_.drive.cycles = 10;
    }

    Score operator()(const std::vector<SceneValue>& values) {
        Scene scene = scene_;
        scene.end.thickness_m = number(values[0]);
        scene.chain.preload_n = number(values[1]);
        return score_of(goal_, options_.columns, *runner_.run(0, scene));
    }

private:
    Scene scene_;
    std::atomic<bool> stop_{false};
    Goal goal_;
    PointOptions options_;
    PointRunner runner_;
};

TEST(Search, FindsTheBestOfAGridWithATenthOfItsEvaluations) {
    constexpr std::int64_t side = 30;
    const Goal goal{"occupied_20db_hz", true, {*parse_constraint("peak_v_out_m_per_s >= 0.3")}};
    Device device(goal);
    const auto grid =
        SweepPlan::make({}, {{two_ranges[0] + ":30", two_ranges[1] + ":30"}, "", "", std::nullopt});
    ASSERT_TRUE(grid);
    double best_of_grid = 0;
    std::int64_t feasible_points = 0;
    for (std::int64_t point = 0; point < side * side; ++point) {
        const Score score = device(grid->values(point));
        feasible_points += score.feasible ? 1 : 0;
        best_of_grid = std::max(best_of_grid, score.feasible ? score.value : 0);
    }
    EXPECT_GT(feasible_points, 100);  // the grid is no trivial one
    EXPECT_LT(feasible_points, 850);
    const Found found = found_in(space_of(two_ranges), side * side / 10, 1, std::ref(device));
    EXPECT_LE(found.evaluations.size(), side * side / 10);
    EXPECT_GE(found.evaluations[found.result.best.centre].score.value, best_of_grid);
}

}  // namespace

}  // namespace hertzline::test
