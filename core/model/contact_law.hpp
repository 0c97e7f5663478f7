#pragma once
// The force between two bodies in contact (docs/model.md, section 3): Hertz's law and its damping.

#include <cmath>

#include "hertzline/materials.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

// Elastic bodies (K. L. Johnson, Contact Mechanics, 1985, chapter 4): force k delta^(3/2).

/// a b/(a + b), of masses or radii: half of two equal numbers, exactly.
inline double in_series(double a, double b) noexcept {
    return a / (1 + a / b);
}

/// Contact modulus of two solids [Pa]: 1/theta_ab = 1/theta_a + 1/theta_b.
inline double contact_modulus(const Solid& a, const Solid& b) noexcept {
    return 1 / (1 / plane_strain_modulus(a) + 1 / plane_strain_modulus(b));
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

// Damping: in every law the force is D delta^q delta', with q and the factor D of the law. It is the slope in time of
// W = D delta^(q + 1)/(q + 1).

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
