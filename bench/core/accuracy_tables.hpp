#pragma once
// Tables of bench_accuracy's results.

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/design_scene.hpp"
#include "tests/support/judged_scene.hpp"

namespace hertzline::bench {

/// A scene and its results at each accuracy.
struct JudgedScene {
    std::string name;  ///< "accuracy/random_019", or its index
    test::DesignScene design;
    std::vector<test::Judgement> judgements;
};

/// Prints a line for each scene: error and estimate at each accuracy.
void print_scenes(const std::vector<JudgedScene>& scenes);

/// Prints for each group of scenes how many meet the accuracy, and how many miss it with and without a warning.
void print_groups(const std::vector<JudgedScene>& scenes);

/// Prints the number of scenes whose step was chosen by pilots.
void print_pilots(const std::vector<JudgedScene>& scenes);

/// Prints the number of misses far beyond accuracy and estimate without a warning.
void print_silent_misses(const std::vector<JudgedScene>& scenes);

/// Prints quantiles of the ratio of estimated to true error.
void print_estimates(const std::vector<JudgedScene>& scenes);

/// Prints the scenes that miss an accuracy, by print_scenes().
void print_misses(const std::vector<JudgedScene>& scenes);

}  // namespace hertzline::bench
