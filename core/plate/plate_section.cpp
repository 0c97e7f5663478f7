#include "core/plate/plate_section.hpp"

#include <numbers>

namespace hertzline {

double shear_modulus(const Solid& solid) noexcept {
    return solid.youngs_modulus_pa / (2 * (1 + solid.poissons_ratio));
}

PlateSection plate_section(const Solid& solid, double thickness_m, double loss_factor) noexcept {
    constexpr double shear_correction = 5.0 / 6;  // kappa^2
    const double h = thickness_m;
    const double nu = solid.poissons_ratio;
    return {.thickness_m = h,
            .bending_n_m = solid.youngs_modulus_pa * h * h * h / (12 * (1 - nu * nu)),
            .mass_kg_per_m2 = solid.density_kg_per_m3 * h,
            .shear_n_per_m = shear_correction * shear_modulus(solid) * h,
            .rotary_kg = solid.density_kg_per_m3 * h * h * h / 12,
            .loss_factor = loss_factor};
}

PlateSection thin(PlateSection section) noexcept {
    section.shear_n_per_m = std::numeric_limits<double>::infinity();
    section.rotary_kg = 0;
    return section;
}

double central_stiffness(const PlateSection& section, double radius_m) noexcept {
    return 16 * std::numbers::pi * section.bending_n_m / (radius_m * radius_m);
}

}  // namespace hertzline
