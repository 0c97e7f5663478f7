#pragma once
// The reference solutions of tests/reference/, and the error of a run against them. For tests and benchmarks.

#include <span>
#include <string>
#include <vector>

#include "hertzline/scene.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::test {

struct ReferenceScene {
    std::string file;  ///< without .csv
    Scene scene;
};

/// Returns all reference scenes, each the default scene with a change.
const std::vector<ReferenceScene>& reference_scenes();

/// Returns the scene of that file. @throws std::out_of_range
const Scene& reference_scene(const std::string& file);

/// A reference's columns, [row]; those that a scene lacks are empty.
struct Reference {
    std::vector<double> v_last, v_plate, v_out;
    double interval_s = 0;  ///< between rows
};
Reference read_reference(const std::string& file);

/// Returns the names of random scenes with a reference, for read_reference(): "accuracy/random_019" and so on.
std::vector<std::string> random_references();

/// Reads the scene of such a name. @throws std::runtime_error
Scene random_reference_scene(const std::string& file);

/// Returns ||a - b|| / ||b||.
double relative_l2(std::span<const double> a, std::span<const double> b);

/// The errors of a run.
struct Comparison {
    double v_last = 0;  ///< relative L2 errors over all rows
    double v_plate = 0;
    double v_out = 0;
    double energy_residual = 0;
    double step_s = 0;
};

/// Runs the scene (resolved here) over the reference's rows. @throws std::runtime_error if it does not run
Comparison compare_with_reference(const Scene& scene, const Reference& reference);

}  // namespace hertzline::test
