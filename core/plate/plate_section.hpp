#pragma once
// A plate's cross-section: all that its bending depends on beside its radius, per area. Thin-plate theory is the limit in which it does
// not shear and has no rotary inertia.

#include <limits>

#include "hertzline/materials.hpp"

namespace hertzline {

struct PlateSection {
    double thickness_m = 0;
    double bending_n_m = 0;                                          ///< D, bending stiffness
    double mass_kg_per_m2 = 0;                                       ///< m
    double shear_n_per_m = std::numeric_limits<double>::infinity();  ///< S_h, shear stiffness
    double rotary_kg = 0;                                            ///< J, rotary inertia
    double loss_factor = 0;

    bool operator==(const PlateSection&) const = default;
};

/// G = E/(2 (1 + nu)) [Pa].
double shear_modulus(const Solid& solid) noexcept;

/// A single layer: D = E h^3/(12 (1 - nu^2)), m = rho h, S_h = 5/6 G h, J = rho h^3/12 (R. D. Mindlin 1951; docs/model.md, section 10).
PlateSection plate_section(const Solid& solid, double thickness_m, double loss_factor) noexcept;

/// The section without shear and rotary inertia.
PlateSection thin(PlateSection section) noexcept;

/// Stiffness [N/m] of a thin disc that is clamped at its rim, under a force at its centre: 16 pi D/a^2 (Timoshenko, Theory of Plates and
/// Shells). A thick disc has none, since a point force shears it infinitely far.
double central_stiffness(const PlateSection& section, double radius_m) noexcept;

}  // namespace hertzline
