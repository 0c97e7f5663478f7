#pragma once
// The chain: its constants, derived once from a Scene and read-only from then on, and its state, which is all that moves.
//
// Bodies 0..N-1 are the spheres, body N is the end (plate, wall, or nothing). Contact c lies left of body c:
// contact 0 is horn - sphere 1, contact N is sphere N - end. So a body and its left contact share an index,
// and bodies() == contacts() == N + 1.
//
// Forces are kept relative to the static state: a chain at rest then has forces of exactly zero and stays at rest.

#include <algorithm>
#include <cstdint>
#include <vector>

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
    Eigen::ArrayXd stiffness;  ///< k [N/m^(3/2)]; 0 where nothing can touch (no horn, free end)
    /// delta0 [m]; 1 where nothing can touch: that never opens nor pushes
    Eigen::ArrayXd static_overlap;
    Eigen::ArrayXd static_force;  ///< k delta0^(3/2) [N], rounded as the kernels round it
    Eigen::ArrayXd
        damping;  ///< factor D of the damping force D delta^q delta' [N s/m^(1+q)]; lambda of a dashpot

    // per body
    Eigen::ArrayXd radius;    ///< [m]; of the end 0
    Eigen::ArrayXd inv_mass;  ///< [1/kg]; 0 of a wall
    Eigen::ArrayXd load;      ///< constant force that the static forces of its contacts balance [N]
    Eigen::ArrayXd spring;    ///< stiffness to ground [N/m]: K_m of a plate, else 0
    Eigen::ArrayXd drag;      ///< of the holder [kg/s]: m/tau of a sphere, else 0
    Eigen::ArrayXd bias;      ///< constant force that the static state leaves unbalanced [N]

    EndModel end;
    DampingLaw damping_law;
    Tension tension;
    double preload_n;            ///< F0 [N]
    double end_force_n = 0;      ///< F0 and the weight of all spheres: the static force on the end [N]
    double horn_inv_mass = 0;    ///< of a resonator on which the chain acts back [1/kg]
    double horn_square = 0;      ///< its omega^2 [1/s^2]
    double holder_rate = 0;      ///< 1/tau: the holder slows each sphere by that times its velocity [1/s]
    double impact_velocity = 0;  ///< of the first spheres at the start [m/s]
    Eigen::Index impact_spheres = 0;  ///< how many they are

    /// 1/mass of the lighter body at a contact [1/kg].
    double mobility(Eigen::Index contact) const noexcept {
        return std::max(contact > 0 ? inv_mass[contact - 1] : horn_inv_mass, inv_mass[contact]);
    }

    /// Whether the static forces hold each other: then nothing moves but strikers, and what they or the horn push.
    bool balanced() const noexcept { return (bias == 0).all(); }
};

/// Faults of a row of spheres that only its masses show: diameters that its taper takes beyond all bounds, weights that pull contacts apart.
/// @param scene has passed validate()
std::vector<Fault> chain_faults(const Scene& scene);

/// These and those of a plate (end.hpp): why a valid scene cannot be computed.
std::vector<Fault> model_faults(const Scene& scene);

/// Displacements, velocities and contacts of a chain.
struct ChainState {
    explicit ChainState(const Chain& chain)
        : x(chain.bodies()), v(chain.bodies()), closed(chain.bodies()), peak_overlap(chain.bodies()) {
        reset(chain);
    }

    /// Back to the start: static equilibrium, in which the first spheres may have a velocity.
    void reset(const Chain& chain) noexcept {
        reset_motion(chain);
        v.head(chain.impact_spheres) = chain.impact_velocity;
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
