#pragma once
// How the chain's far end couples to the medium: the clamped plate and the acoustic transmission through it.

#include "core/scene/scene.hpp"

namespace hertzline {

/// Mass [kg] of the whole disc, rho pi a^2 h. Clamped at its rim, it moves as a quarter of that would
/// (docs/model.md, section 4).
double plate_mass(const Solid& material, const End& end) noexcept;

/// Stiffness [N/m] of a clamped disc under a central load: 16 pi D / a^2 with D = E h^3 / (12 (1 - nu^2))
/// (Timoshenko, Theory of Plates and Shells), unless the scene gives its own.
double plate_stiffness(const Solid& material, const End& end) noexcept;

/// Power transmission from impedance a into b: 1 - ((Zb - Za)/(Zb + Za))^2.
double transmission(double impedance_a, double impedance_b) noexcept;

/// sqrt(T_m T_w): amplitude factor from the last sphere through the disc into the medium (docs/model.md, section 6).
double output_transmission(const Scene& scene);

}  // namespace hertzline
