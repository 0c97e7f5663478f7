#pragma once
// Input and output of every solver of bench_work_precision.
//
// The peers see plain numbers only, in units that suit an adaptive solver: lengths in drive amplitudes and times in
// microseconds. Displacements and velocities are then of the order of one, and one tolerance serves both. Eigen is
// not used here: the peers are compiled for this machine, and Eigen's alignment depends on that.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "hertzline/scene.hpp"

namespace hertzline::bench {

/// Constants of the equations of motion (core/model/chain.hpp) in units of the drive's amplitude, 1 us and 1 kg.
struct Problem {
    std::size_t bodies;       ///< moving bodies: spheres, and the plate if there is one
    std::size_t last_sphere;  ///< index of the last sphere
    bool plate;               ///< the last body is a plate
    std::size_t contacts;     ///< contacts that can open and close
    // per contact, bodies + 1; contact c is on the left of body c. The contact on the right of a plate or of a
    // free end never pushes
    std::vector<double> stiffness, static_overlap, damping;
    // per body; load is a constant force toward the horn
    std::vector<double> inv_mass, spring, load;
    double carrier, envelope;  ///< angular frequencies of a hann burst [rad/us]
    double burst;              ///< its duration [us]
    double sample_period;      ///< [us]
    std::size_t samples;       ///< the first at t = 0
    double velocity_unit;      ///< [m/s]
    double transmission;       ///< sqrt(T_m T_w), from the last sphere into the medium
};

/// Converts a scene. @throws std::invalid_argument for features that the peers lack: repeated bursts, envelopes other
/// than Hann, clamped tension.
Problem problem(const Scene& scene, std::size_t samples);

/// The sampled outputs [m/s]; without a plate only v_last.
struct Trace {
    explicit Trace(const Problem& of);
    std::vector<double> v_last, v_plate, v_out;
};

enum class Kind {
    ours,
    as_it_comes,  ///< a library's method called as its manual shows
    located       ///< a library's method around which contacts are located, as a careful user would
};

/// A method at one setting. Everything that can be prepared has been.
struct Contender {
    Kind kind;
    std::string name;
    std::string setting;
    /// Runs from the state at rest at t = 0 through all samples. @throws std::runtime_error when the method fails.
    std::function<void(Trace&)> run;
};

std::vector<Contender> hertzline_contenders(const Scene& scene);
/// Makes hertzline at one setting. @param scene resolved
Contender hertzline_contender(const Scene& scene);
/// Makes dopri5 at one setting, either as it comes or located.
Contender odeint_dopri5(const Problem& problem, double tolerance);
Contender odeint_dopri5_located(const Problem& problem, double tolerance);
std::vector<Contender> odeint_contenders(const Problem& problem);
std::vector<Contender> odeint_located_contenders(const Problem& problem);
std::vector<Contender> cvode_contenders(const Problem& problem);
std::vector<Contender> arkode_contenders(const Problem& problem);

}  // namespace hertzline::bench
