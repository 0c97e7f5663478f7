#pragma once
// The chain's constants, derived once from a Scene and read-only from then on.
//
// Bodies 0..N-1 are the spheres, body N is the end (plate, wall, or nothing). Contact c lies left of body c:
// contact 0 is horn - sphere 1, contact N is sphere N - end. So a body and its left contact share an index,
// and bodies() == contacts() == N + 1.
//
// Forces are kept relative to the static state: a chain at rest then has forces of exactly zero and stays at rest.

#include <Eigen/Core>

#include "core/model/end.hpp"
#include "core/scene/scene.hpp"

namespace hertzline {

/// The constants of a chain: what the equations of motion need, in SI units. Read-only once it is made.
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
    Eigen::ArrayXd inv_mass;  ///< [1/kg]; 0 for what cannot move
    Eigen::ArrayXd spring;    ///< stiffness to ground [N/m]: K_m of a plate, else 0
    Eigen::ArrayXd bias;      ///< constant force that the static state leaves unbalanced [N]

    EndModel end;
    DampingLaw damping_law;
    Tension tension;
    double preload_n;  ///< F0 [N]
};

}  // namespace hertzline
