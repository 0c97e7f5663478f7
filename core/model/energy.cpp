#include "core/model/energy.hpp"

#include "core/model/contact_law.hpp"

namespace hertzline {

double kinetic_energy(const Chain& chain, const ChainState& state) noexcept {
    double twice = 0;
    const Eigen::Index bodies =
        chain.end.plate ? chain.spheres() : chain.bodies();  // a modal plate is no single mass
    for (Eigen::Index b = 0; b < bodies; ++b) {
        if (chain.inv_mass[b] > 0) {
            twice += state.v[b] * state.v[b] / chain.inv_mass[b];
        }
    }
    return twice / 2;
}

double stored_energy(const Chain& chain, const ChainState& state, double horn_x) noexcept {
    double energy = 0;
    double left = horn_x;
    for (Eigen::Index b = 0; b < chain.bodies(); ++b) {
        energy += elastic_energy(chain.stiffness[b], chain.static_overlap[b] + (left - state.x[b]));
        left = state.x[b];
    }
    const Eigen::Index n = chain.spheres();
    return energy + chain.spring[n] * state.x[n] * state.x[n] / 2 - (chain.load * state.x).sum();
}

void begin_ledger(const Chain& chain, const ChainState& state, Ledger& ledger) noexcept {
    ledger.kinetic_at_start = kinetic_energy(chain, state);
    ledger.at_start = ledger.kinetic_at_start + stored_energy(chain, state, 0);
}

double work_of_jump(const Chain& chain, double x, double horn_before, double horn_after) noexcept {
    const auto stored = [&](double horn) {
        return elastic_energy(chain.stiffness[0], chain.static_overlap[0] + (horn - x));
    };
    return stored(horn_after) - stored(horn_before);
}

}  // namespace hertzline
