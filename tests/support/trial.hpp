#pragma once
// Runs a scene and checks the promises of every run.

#include <cstdint>
#include <string>
#include <vector>

#include "hertzline/scene.hpp"

namespace hertzline::test {

enum class Outcome {
    ran,      ///< to the end
    stopped,  ///< by a status other than running
    refused,  ///< by a fault of resolve()
};

/// The result of a scene's trial.
struct Trial {
    Outcome outcome = Outcome::ran;
    Integrator integrator = Integrator::leapfrog;
    double simulated_s = 0;
    std::int64_t steps = 0;  ///< or pieces
    double crowding = 0;     ///< steps over the number that rates of change and contact events call for
    double residual = 0;     ///< of the energy ledger, over all energy that came and went
    std::string message;     ///< of a stop or a refusal
    std::vector<std::string> findings;  ///< broken promises
};

/// Runs the scene for at most a few thousand steps, and checks all its outputs.
Trial tried(const Scene& scene);

}  // namespace hertzline::test
