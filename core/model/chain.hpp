#pragma once
// The chain: its constants, derived once from a Scene and read-only from then on, and its state, which is all that moves.
//
// Bodies 0..N-1 are the spheres, body N is the end (plate, wall, or nothing). Contact c lies left of body c:
// contact 0 is horn - sphere 1, contact N is sphere N - end. So a body and its left contact share an index,
// and bodies() == contacts() == N + 1.
//
// Forces are kept relative to the static state: a chain at rest then has forces of exactly zero and stays at rest.

#include <cstdint>

#include <Eigen/Core>

#include "core/model/end.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// The constants of the equations of motion, in SI units.
struct Chain {
    /// @param scene has passed validate(). @throws std::bad_alloc
    explicit Chain(const Scene& scene);

    Eigen::Index spheres() const noexcept { return stiffness.size() - 1; }
    Eigen::Index bodies() const noexcept { return stiffness.size(); }

    // per contact
    Eigen::ArrayXd stiffness;  ///< k [N/m^(3/2)]; 0 where nothing can touch (free end)
    /// delta0 [m]; 1 at the contact of a free end, which never opens nor pushes
    Eigen::ArrayXd static_overlap;
    Eigen::ArrayXd static_force;  ///< k delta0^(3/2) [N], rounded as the kernels round it
    Eigen::ArrayXd
        damping;  ///< factor D of the damping force D delta^q delta' [N s/m^(1+q)]; lambda of a dashpot

    // per body
    Eigen::ArrayXd inv_mass;  ///< [1/kg]; 0 of a wall
    Eigen::ArrayXd spring;    ///< stiffness to ground [N/m]: K_m of a plate, else 0
    Eigen::ArrayXd bias;      ///< constant force that the static state leaves unbalanced [N]

    EndModel end;
    DampingLaw damping_law;
    Tension tension;
    double preload_n;  ///< F0 [N]
};

/// Displacements, velocities and contacts of a chain.
struct ChainState {
    explicit ChainState(const Chain& chain)
        : x(chain.bodies()), v(chain.bodies()), closed(chain.bodies()), peak_overlap(chain.bodies()) {
        reset(chain);
    }

    /// Back to static equilibrium.
    void reset(const Chain& chain) noexcept {
        reset_motion(chain);
        peak_overlap = chain.static_overlap;
        step = 0;
    }

    /// Back to the motion of static equilibrium; peaks and steps stay.
    void reset_motion(const Chain& chain) noexcept {
        x.setZero();
        v.setZero();
        closed = (chain.static_overlap > 0).cast<double>();
    }

    /// Takes the motion of another chain that is equal to this one; peaks start from there.
    void take_motion(const ChainState& other) noexcept {
        x = other.x;
        v = other.v;
        closed = other.closed;
    }

    Eigen::ArrayXd x;       ///< displacement from static equilibrium [m], bodies()
    Eigen::ArrayXd v;       ///< velocity [m/s], bodies()
    Eigen::ArrayXd closed;  ///< 1 while the contact touches, else 0, contacts()
    /// Largest overlap so far [m], contacts(): the stability limit depends on it.
    Eigen::ArrayXd peak_overlap;
    std::int64_t step = 0;  ///< steps taken; time is step * h, never accumulated
};

}  // namespace hertzline
