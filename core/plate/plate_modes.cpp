#include "core/plate/plate_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/plate/disc_modes.hpp"

namespace hertzline {

namespace {

// A mode without loss would have a pole on the axis; this loss takes 0.3 % of its amplitude in ten thousand periods.
constexpr double least_loss_factor = 1e-7;

}  // namespace

std::vector<PlateMode> dry_modes(const PlateParameters& p) {
    const double h = p.thickness_m;
    const double area = std::numbers::pi * p.radius_m * p.radius_m;
    const double nu = p.disc.poissons_ratio;
    const double bending = p.disc.youngs_modulus_pa * h * h * h / (12 * (1 - nu * nu));
    const double mass = p.disc.density_kg_per_m3 * h;
    std::vector<PlateMode> modes;
    for (int n = 0; n < p.modes; ++n) {
        const DiscMode disc(n);
        const double number = disc.root() / p.radius_m;
        const double omega = number * number * std::sqrt(bending / mass);
        PlateMode mode{.mass_kg = disc.mass() * mass * area,
                       .mean = disc.mean(),
                       .dry_hz = omega / (2 * std::numbers::pi),
                       .kb_h = number * h};
        mode.stiffness_n_per_m = mode.mass_kg * omega * omega;
        mode.loss_kg_per_s = std::max(p.loss_factor, least_loss_factor) * mode.stiffness_n_per_m / omega;
        modes.push_back(mode);
    }
    return modes;
}

double highest_dry_hz(const PlateParameters& parameters) {
    return dry_modes(parameters).back().dry_hz;
}

}  // namespace hertzline
