#pragma once
// The error of a run over its whole duration, beside the program's estimate and warnings before the run.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hertzline/resolve.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/taps.hpp"

namespace hertzline::test {

/// An output whose r.m.s. value is below this part of the loudest velocity's is judged on that scale.
inline constexpr double quietest_output = 1e-6;

/// Errors below this are not distinguished: references are not better.
inline constexpr double indistinguishable = 1e-9;

/// The outputs that are judged, where a scene has them.
inline constexpr std::array output_taps{Tap::v_last, Tap::v_plate, Tap::v_out,   Tap::v_centre,
                                        Tap::v_face, Tap::p_axis,  Tap::p_points};

/// The outputs of a scene.
struct Outputs {
    /// Of output_taps, row-major [row][channel], as velocities [m/s]; row r is sample r * samples_per_row.
    std::array<std::vector<double>, output_taps.size()> columns;
    std::array<std::size_t, output_taps.size()> channels{1, 1, 1, 1, 1, 1, 1};
    std::size_t samples_per_row = 1;
    double loudest = 0;     ///< r.m.s. of the sphere, plate or output that moves most [m/s]
    bool complete = false;  ///< the run reached its end
};

/// Returns the worst output's relative L2 difference; infinity if a run is not complete or not finite.
/// @param run with every sample
double difference(const Outputs& run, const Outputs& truth);

/// A reference for a scene's motion.
struct Truth {
    Outputs outputs;
    double error = 0;  ///< of the reference itself, relative L2
};

/// Runs taylor12 with the shortest useful pieces. Another run with longer ones, and another fit of a modal plate, gives the error.
Truth truth_of(const Scene& scene);

/// Reads the independent solution of random_references(). Its error is its difference from the run of truth_of().
Truth independent_truth_of(const Scene& scene, const std::string& file);

/// The true error of a run at an accuracy, and the program's estimate and warning.
struct Judgement {
    double accuracy = 0;  ///< requested
    double error = 0;
    double truth_error = 0;
    std::optional<double> estimate;  ///< of the error
    bool warned = false;
    Integrator integrator = Integrator::leapfrog;
    bool pilots = true;  ///< pilots have chosen the step

    bool met() const noexcept { return error <= accuracy; }
    /// Is the error within three times the requested accuracy?
    bool nearly_met() const noexcept { return error <= 3 * accuracy; }
    /// Does the motion amplify rounding errors so much that the reference's own error is above a tenth of the run's?
    bool amplifies() const noexcept { return truth_error > indistinguishable && truth_error > 0.1 * error; }
    /// Is the error far above the requested accuracy and the estimate, without a warning?
    bool silent_miss() const noexcept {
        return !warned && !nearly_met() && !(error <= 3 * estimate.value_or(0));
    }
};

/// Resolves and runs the scene at that accuracy. @throws std::runtime_error if it is refused
Judgement judged(const Scene& scene, const Truth& truth, double accuracy);

/// Resolves and runs the scene as a sweep does: with a finer run beside it, and with pilots only where that run misses
/// the accuracy.
Judgement judged_by_finer_run(const Scene& scene, const Truth& truth, double accuracy);

}  // namespace hertzline::test
