#include "core/model/coupling.hpp"

#include <cmath>
#include <numbers>

namespace hertzline {

double plate_mass(const Solid& material, const End& end) noexcept {
    return material.density_kg_per_m3 * std::numbers::pi * end.radius_m * end.radius_m * end.thickness_m;
}

double plate_stiffness(const Solid& material, const End& end) noexcept {
    if (end.stiffness_n_per_m) {
        return *end.stiffness_n_per_m;
    }
    const double h = end.thickness_m;
    const double nu = material.poissons_ratio;
    const double bending_stiffness = material.youngs_modulus_pa * h * h * h / (12 * (1 - nu * nu));
    return 16 * std::numbers::pi * bending_stiffness / (end.radius_m * end.radius_m);
}

double transmission(double impedance_a, double impedance_b) noexcept {
    const double reflection = (impedance_b - impedance_a) / (impedance_b + impedance_a);
    return 1 - reflection * reflection;
}

double output_transmission(const Scene& scene) {
    const double sphere = acoustic_impedance(*find_material(scene, scene.chain.material));
    const double disc = acoustic_impedance(*find_material(scene, scene.end.material));
    const double medium = acoustic_impedance(*find_material(scene, scene.medium.material));
    return std::sqrt(transmission(sphere, disc) * transmission(disc, medium));
}

}  // namespace hertzline
