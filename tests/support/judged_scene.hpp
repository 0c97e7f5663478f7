#pragma once
// How far a run is from the truth over all of its duration, and what the program says about that beforehand.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/step_choice/resolve.hpp"

namespace hertzline::test {

/// An output whose r.m.s. value is below this part of the loudest velocity's is judged on that scale.
inline constexpr double quietest_output = 1e-6;

/// Errors below this are not told apart: that is how good references are.
inline constexpr double indistinguishable = 1e-9;

/// What comes out of a scene.
struct Outputs {
    /// v_last, and with a plate v_plate and v_out [m/s]; row r is sample r * samples_per_row
    std::array<std::vector<double>, 3> columns;
    std::size_t samples_per_row = 1;
    double loudest = 0;     ///< r.m.s. of the sphere, plate or output that moves most [m/s]
    bool complete = false;  ///< false: the run stopped before its end
};

/// The worst output's relative L2 difference. Infinite if one is not complete or not finite.
/// @param run with every sample
double difference(const Outputs& run, const Outputs& truth);

/// A scene's motion, as good as it can be had.
struct Truth {
    Outputs outputs;
    double error = 0;  ///< its own, relative L2
};

/// taylor12 with pieces as short as is of use, and again with shorter ones, which shows the error.
Truth truth_of(const Scene& scene);

/// The independent solution of random_references(). Its error is what truth_of() differs from it.
Truth independent_truth_of(const Scene& scene, const std::string& file);

/// What a run at an accuracy is worth, and what was said about it.
struct Judgement {
    double accuracy = 0;  ///< that was asked for
    double error = 0;
    double truth_error = 0;
    std::optional<double> estimate;  ///< of the error
    bool warned = false;
    Integrator integrator = Integrator::leapfrog;
    bool pilots = true;  ///< have chosen the step

    bool met() const noexcept { return error <= accuracy; }
    /// Within three times what was asked for.
    bool nearly_met() const noexcept { return error <= 3 * accuracy; }
    /// The motion amplifies rounding errors so much that not even the truth is good to a tenth of the error.
    bool amplifies() const noexcept { return truth_error > indistinguishable && truth_error > 0.1 * error; }
    /// Far from what was asked for and from what was estimated, without a warning.
    bool silent_miss() const noexcept {
        return !warned && !nearly_met() && !(error <= 3 * estimate.value_or(0));
    }
};

/// Resolves and runs the scene at that accuracy. @throws std::runtime_error if it is refused
Judgement judged(const Scene& scene, const Truth& truth, double accuracy);

/// The same, as a sweep does: with a finer run beside it, and pilots only where that does not convince.
Judgement judged_by_finer_run(const Scene& scene, const Truth& truth, double accuracy);

}  // namespace hertzline::test
