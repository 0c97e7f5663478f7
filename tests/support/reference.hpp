#pragma once
// The reference solutions of tests/reference/ and how far a run is from them. For tests and benchmarks.

#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/simulation.hpp"

namespace hertzline::test {

struct ReferenceScene {
    std::string file;  ///< without .csv
    Scene scene;
};

/// All of them, each the default scene with its change.
const std::vector<ReferenceScene>& reference_scenes();

/// The scene of that file. Throws std::out_of_range.
const Scene& reference_scene(const std::string& file);

/// A reference's columns, [row]; those that a scene lacks are empty.
struct Reference {
    std::vector<double> v_last, v_plate, v_out;
    double interval_s = 0;  ///< between rows
};
Reference read_reference(const std::string& file);

/// Scenes drawn at random that have a reference: their names for read_reference(), "accuracy/random_019" and so on.
std::vector<std::string> random_references();

/// The scene of such a name. Throws std::runtime_error.
Scene random_reference_scene(const std::string& file);

/// ||a - b|| / ||b||.
double relative_l2(std::span<const double> a, std::span<const double> b);

/// How a run compares.
struct Comparison {
    double v_last = 0;  ///< relative L2 errors over all rows
    double v_plate = 0;
    double v_out = 0;
    double energy_residual = 0;
    double step_s = 0;
};

/// Runs the scene (resolved here) over the reference's rows. Throws std::runtime_error if it does not run.
Comparison compare_with_reference(const Scene& scene, const Reference& reference);

}  // namespace hertzline::test
