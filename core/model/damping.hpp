#pragma once
// What closed contacts lose (docs/model.md, section 3). In every law the damping force is D delta^q delta', with q and the factor D of
// the law. It is the slope of W = D delta^(q + 1)/(q + 1) in time.

#include <cmath>

#include "core/scene/scene.hpp"

namespace hertzline {

/// q, the power of the overlap in a law's damping force.
constexpr double damping_exponent(DampingLaw law) noexcept {
    switch (law) {
        case DampingLaw::dashpot:
            return 0;
        case DampingLaw::kuwabara_kono:
            return 0.5;
        case DampingLaw::tsuji:
            return 0.25;
    }
    return 0;
}

/// delta^q of a closed contact's overlap [m], by square roots: the same bits as the SIMD kernels.
inline double damping_power(DampingLaw law, double overlap_m) noexcept {
    switch (law) {
        case DampingLaw::dashpot:
            return 1;
        case DampingLaw::kuwabara_kono:
            return std::sqrt(overlap_m > 0 ? overlap_m : 0);
        case DampingLaw::tsuji:
            return std::sqrt(std::sqrt(overlap_m > 0 ? overlap_m : 0));
    }
    return 0;
}

/// Factor D [N s/m^(1+q)] of a contact of stiffness k [N/m^(3/2)] whose bodies have the reduced mass m [kg].
inline double damping_factor(const Spheres& chain, double stiffness, double mass_kg) noexcept {
    if (stiffness <= 0) {
        return 0;  // a free end: nothing to touch
    }
    switch (chain.damping_law) {
        case DampingLaw::dashpot:
            return chain.damping_kg_per_s;
        case DampingLaw::kuwabara_kono:
            return 1.5 * chain.damping_time_s.value_or(0) * stiffness;
        case DampingLaw::tsuji:
            return chain.damping_alpha.value_or(0) * std::sqrt(mass_kg * stiffness);
    }
    return 0;
}

}  // namespace hertzline
