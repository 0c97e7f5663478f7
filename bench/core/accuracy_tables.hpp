#pragma once
// What bench_accuracy found, as tables.

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/design_scene.hpp"
#include "tests/support/judged_scene.hpp"

namespace hertzline::bench {

/// A scene, and how it fared at each accuracy.
struct JudgedScene {
    std::string name;  ///< "accuracy/random_019", or its index
    test::DesignScene design;
    std::vector<test::Judgement> judgements;
};

/// A line for each scene: error and estimate at each accuracy.
void print_scenes(const std::vector<JudgedScene>& scenes);

/// Counts for each group of scenes: the accuracy is met, or missed with and without a warning.
void print_groups(const std::vector<JudgedScene>& scenes);

/// For how many of them pilots have chosen the step.
void print_pilots(const std::vector<JudgedScene>& scenes);

/// Misses far beyond the accuracy and the estimate, without a warning.
void print_silent_misses(const std::vector<JudgedScene>& scenes);

/// Estimated over true errors.
void print_estimates(const std::vector<JudgedScene>& scenes);

/// Those that miss an accuracy, as print_scenes().
void print_misses(const std::vector<JudgedScene>& scenes);

}  // namespace hertzline::bench
