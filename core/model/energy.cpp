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
    energy += chain.spring[n] * state.x[n] * state.x[n] / 2;
    switch (chain.end.loaded) {
        case EndLoad::none:
            return energy;
        case EndLoad::last_sphere:
            return energy + chain.preload_n * state.x[n - 1];
        case EndLoad::end:
            return energy + chain.preload_n * state.x[n];
    }
    return energy;
}

double work_of_jump(const Chain& chain, double x, double horn_before, double horn_after) noexcept {
    const auto stored = [&](double horn) {
        return elastic_energy(chain.stiffness[0], chain.static_overlap[0] + (horn - x));
    };
    return stored(horn_after) - stored(horn_before);
}

}  // namespace hertzline
