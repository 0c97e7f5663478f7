#include "core/plate/plate_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hertzline {

namespace {

// A mode without loss would have a pole on the axis; this loss takes 0.3 % of its amplitude in ten thousand periods.
constexpr double least_loss_factor = 1e-7;

}  // namespace

std::vector<DiscMode> disc_modes(const PlateParameters& p) {
    const PlateSection& section = p.section;
    const double square = p.radius_m * p.radius_m;
    return disc_modes(p.modes, {.rotary = section.rotary_kg / (section.mass_kg_per_m2 * square),
                                .compliance = section.bending_n_m / (section.shear_n_per_m * square)});
}

std::vector<PlateMode> dry_modes(const PlateParameters& p) {
    const double area = std::numbers::pi * p.radius_m * p.radius_m;
    const double mass = p.section.mass_kg_per_m2;
    std::vector<PlateMode> modes;
    for (const DiscMode& disc : disc_modes(p)) {
        const double number = disc.root() / p.radius_m;
        const double omega = number * number * std::sqrt(p.section.bending_n_m / mass) * disc.slowing();
        PlateMode mode{.mass_kg = disc.mass() * mass * area,
                       .mean = disc.mean(),
                       .dry_hz = omega / (2 * std::numbers::pi),
                       .kb_h = number * p.section.thickness_m};
        mode.stiffness_n_per_m = mode.mass_kg * omega * omega;
        mode.loss_kg_per_s =
            std::max(p.section.loss_factor, least_loss_factor) * mode.stiffness_n_per_m / omega;
        modes.push_back(mode);
    }
    return modes;
}

double highest_dry_hz(const PlateParameters& parameters) {
    return dry_modes(parameters).back().dry_hz;
}

}  // namespace hertzline
