#include "core/solvers/extent.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/energy.hpp"

namespace hertzline {

MotionExtent extent_of(Solver& solver, const Chain& chain) noexcept {
    MotionExtent extent{.time_s = solver.time_s(),
                        .contact_events = solver.contact_events(),
                        .energy_residual = energy_residual(solver, chain)};
    const ChainState& state = solver.state();
    for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
        if (chain.stiffness[c] > 0) {  // the contact of a free end never pushes
            extent.last_press_m = state.peak_overlap[c] - chain.static_overlap[c];
            extent.largest_press_m = std::max(extent.largest_press_m, extent.last_press_m);
        }
    }
    return extent;
}

double energy_missing(Solver& solver, const Chain& chain) noexcept {
    const Ledger ledger = solver.ledger();
    const ChainState& now = solver.state();
    const double held = kinetic_energy(chain, now) + stored_energy(chain, now, solver.horn_displacement());
    return std::abs(held - ledger.at_start - ledger.work + ledger.lost + ledger.passed);
}

double energy_residual(Solver& solver, const Chain& chain) noexcept {
    const Ledger ledger = solver.ledger();
    const double moved = std::max({ledger.gross_work, ledger.lost, kinetic_energy(chain, solver.state())});
    return moved > 0 ? energy_missing(solver, chain) / moved : 0;
}

}  // namespace hertzline
