#pragma once
// What moves. Everything else about a run is read-only (Chain) or bookkeeping (Ledger).

#include <cstdint>

#include <Eigen/Core>

#include "core/model/chain.hpp"

namespace hertzline {

/// The motion of a chain: displacements, velocities and contacts.
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

    /// The motion of static equilibrium; what was counted on the way stays.
    void reset_motion(const Chain& chain) noexcept {
        x.setZero();
        v.setZero();
        closed = (chain.static_overlap > 0).cast<double>();
    }

    /// The motion of another chain that is equal to this one; peaks are counted from there on.
    void take_motion(const ChainState& other) noexcept {
        x = other.x;
        v = other.v;
        closed = other.closed;
    }

    Eigen::ArrayXd x;       ///< displacement from static equilibrium [m], bodies()
    Eigen::ArrayXd v;       ///< velocity [m/s], bodies()
    Eigen::ArrayXd closed;  ///< 1 while the contact touches, else 0, contacts()
    /// Largest overlap so far [m], contacts(); tells whether the step is still stable.
    Eigen::ArrayXd peak_overlap;
    std::int64_t step = 0;  ///< steps taken; time is step * h, never accumulated
};

}  // namespace hertzline
