#pragma once
// Hertz's law between elastic bodies (K. L. Johnson, Contact Mechanics, 1985, chapter 4): force k delta^(3/2).

#include <cmath>

#include "core/scene/materials.hpp"

namespace hertzline {

/// Contact modulus of two solids [Pa]: 1/theta_ab = 1/theta_a + 1/theta_b.
inline double contact_modulus(const Solid& a, const Solid& b) noexcept {
    return 1 / (1 / plane_strain_modulus(a) + 1 / plane_strain_modulus(b));
}

/// Stiffness k [N/m^(3/2)] between two equal spheres of radius R [m] of one material: sqrt(2R)/3 theta.
inline double sphere_sphere_stiffness(const Solid& sphere, double radius_m) noexcept {
    return std::sqrt(2 * radius_m) / 3 * plane_strain_modulus(sphere);
}

/// Stiffness k [N/m^(3/2)] between a flat body and a sphere of radius R [m]: 4 sqrt(R)/3 theta_ab.
inline double flat_sphere_stiffness(const Solid& flat, const Solid& sphere, double radius_m) noexcept {
    return 4 * std::sqrt(radius_m) / 3 * contact_modulus(flat, sphere);
}

/// Overlap [m] at which a contact of stiffness k carries the force [N]: (F/k)^(2/3).
inline double static_overlap(double stiffness, double force_n) noexcept {
    return std::cbrt((force_n / stiffness) * (force_n / stiffness));
}

/// Elastic force [N] at an overlap [m]; zero when apart. x*sqrt(x), not pow: the same bits as the SIMD kernels.
inline double elastic_force(double stiffness, double overlap_m) noexcept {
    const double pressed = overlap_m > 0 ? overlap_m : 0;
    return (stiffness * pressed) * std::sqrt(pressed);
}

/// Slope of the elastic force [N/m]: 3/2 k sqrt(delta).
inline double tangent_stiffness(double stiffness, double overlap_m) noexcept {
    return overlap_m > 0 ? 1.5 * stiffness * std::sqrt(overlap_m) : 0;
}

/// Energy [J] stored in a contact: (2/5) k delta^(5/2).
inline double elastic_energy(double stiffness, double overlap_m) noexcept {
    return 0.4 * elastic_force(stiffness, overlap_m) * (overlap_m > 0 ? overlap_m : 0);
}

}  // namespace hertzline
