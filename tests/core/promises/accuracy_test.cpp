// The requested accuracy is kept over the whole run, or the program warns.

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/design_scene.hpp"
#include "tests/support/judged_scene.hpp"
#include "tests/support/reference.hpp"

namespace hertzline::test {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::uint64_t drawn_scenes = 6;  // ten times as slow
constexpr std::array accuracies{1e-4};
#else
constexpr std::uint64_t drawn_scenes = 60;
constexpr std::array accuracies{1e-3, 1e-4, 1e-6};
#endif

void expect_kept_or_warned(const Judgement& judgement) {
    // A run's error is known only to within the error of its reference.
    const bool may_be_met = judgement.error <= judgement.accuracy + judgement.truth_error;
    EXPECT_TRUE(may_be_met || judgement.warned)
        << "asked " << judgement.accuracy << ", error " << judgement.error << ", estimate "
        << judgement.estimate.value_or(0);
}

/// Those that amplify errors so much that no solution is good.
bool is_chaotic(const std::string& file) {
    return file.ends_with("random_251") || file.ends_with("random_292");
}

/// How far a solution may be from an exact run: twice its error (tests/reference/README.md).
double error_of_reference(const std::string& file) {
    return 2 * (file.ends_with("random_387") ? 1e-4 : file.ends_with("random_075") ? 1e-6 : 1e-7);
}

class RandomReference : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Scenes, RandomReference, ::testing::ValuesIn(random_references()),
                         [](const auto& instance) {
                             return instance.param.substr(instance.param.find('/') + 1);
                         });

TEST_P(RandomReference, AccuracyIsKeptToTheEndOfTheRunOrWarnedOf) {
    const Scene scene = random_reference_scene(GetParam());
    const Truth truth = independent_truth_of(scene, GetParam());
    if (!is_chaotic(GetParam())) {
        EXPECT_LE(truth.error, error_of_reference(GetParam()));
    }
    for (const double accuracy : accuracies) {
        for (const Judgement& judgement :
             {judged(scene, truth, accuracy), judged_by_finer_run(scene, truth, accuracy)}) {
            expect_kept_or_warned(judgement);
            EXPECT_TRUE(judgement.warned || !is_chaotic(GetParam()));
        }
    }
}

using Judge = Judgement (*)(const Scene&, const Truth&, double);

class DrawnScenes : public ::testing::TestWithParam<Judge> {};

INSTANTIATE_TEST_SUITE_P(Judges, DrawnScenes, ::testing::Values(&judged, &judged_by_finer_run),
                         [](const auto& instance) {
                             return std::string(instance.param == &judged ? "Pilots" : "FinerRun");
                         });

TEST_P(DrawnScenes, KeepTheAccuracyOrAreWarnedOfAndTheEstimateHolds) {
    int judgements = 0;
    int within_three = 0;
    for (std::uint64_t index = 0; index < drawn_scenes; ++index) {
        const Scene scene = design_scene(2, index).scene;
        SCOPED_TRACE(description(scene));
        const Truth truth = truth_of(scene);
        ASSERT_TRUE(std::isfinite(truth.error));
        for (const double accuracy : accuracies) {
            const Judgement judgement = GetParam()(scene, truth, accuracy);
            expect_kept_or_warned(judgement);
            if (!judgement.amplifies()) {
                ASSERT_TRUE(judgement.estimate.has_value());
                const double error = std::max(judgement.error, indistinguishable);
                const double estimate = std::max(*judgement.estimate, indistinguishable);
                ++judgements;
                within_three += estimate <= 3 * error && error <= 3 * estimate ? 1 : 0;
            }
        }
    }
    EXPECT_GE(judgements, static_cast<int>(drawn_scenes));
    EXPECT_GE(within_three, 0.95 * judgements);
}

}  // namespace
}  // namespace hertzline::test
