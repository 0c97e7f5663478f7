#pragma once
// How far a motion has gone: a few numbers that tell whether it is still like the motion that somebody has seen.

#include <cstdint>

#include "core/model/chain.hpp"
#include "core/solvers/solver.hpp"

namespace hertzline {

/// From the start to some moment.
struct MotionExtent {
    double time_s = 0;                ///< the moment [s]
    double largest_press_m = 0;       ///< largest overlap of any contact so far, beyond that at rest [m]
    double last_press_m = 0;          ///< the same of the last contact [m]
    std::int64_t contact_events = 0;  ///< openings and closings so far
    double energy_residual = 0;       ///< as energy_residual() below
};

/// Takes a pass over the chain; allocates nothing.
MotionExtent extent_of(Solver& solver, const Chain& chain) noexcept;

/// Energy that no entry of the ledger accounts for, |kinetic + stored - start - work + lost + passed| [J].
double energy_missing(Solver& solver, const Chain& chain) noexcept;
/// The same over what came and went: the horn's work back and forth, or the losses, or the kinetic energy, whichever is largest.
double energy_residual(Solver& solver, const Chain& chain) noexcept;

}  // namespace hertzline
