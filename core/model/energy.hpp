#pragma once
// The energy ledger (docs/model.md, section 8): kinetic + stored - (their value at 0) - work + lost + passed + the holder's loss must stay zero.

#include <cmath>

#include "core/model/chain.hpp"
#include "hertzline/ledger.hpp"

namespace hertzline {

/// sum m v^2/2 over the spheres and the paper's plate [J].
double kinetic_energy(const Chain& chain, const ChainState& state) noexcept;

/// sum (2/5) k delta^(5/2) + K_m x_m^2/2 - sum of load x [J], with the horn displaced by horn_x [m]. Loads are weights, the preload where
/// there is no horn, and the force by which the end holds against them.
double stored_energy(const Chain& chain, const ChainState& state, double horn_x) noexcept;

/// The energies at the start.
void begin_ledger(const Chain& chain, const ChainState& state, Ledger& ledger) noexcept;

/// Work of the horn when its end jumps: the change of the energy that contact 0 stores [J]. @param x of the first sphere [m]
double work_of_jump(const Chain& chain, double x, double horn_before, double horn_after) noexcept;

}  // namespace hertzline
