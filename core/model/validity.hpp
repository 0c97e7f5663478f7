#pragma once
// Where a scene leaves the range of its equations. Nothing here is refused: the equations can still be solved.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/model/chain.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline {

/// Pressure at the centre of a contact of stiffness k [N/m^(3/2)] at an overlap [m]: 3 k sqrt(overlap) / (2 pi R) [Pa]
/// (K. L. Johnson, Contact Mechanics, 1985, equation 4.24). @param radius_m relative radius of curvature: R of a sphere
/// on a flat body, R/2 between two spheres
double contact_pressure(double stiffness, double overlap_m, double radius_m) noexcept;

/// Relative radius of curvature of a contact [m]: R of a sphere on a flat body, R_a R_b/(R_a + R_b) between two spheres.
double curvature_radius(const Chain& chain, Eigen::Index contact) noexcept;

/// 0, 1, 2: of the horn, between spheres, of the end (ContactLoad::pressures_pa).
inline std::size_t kind_of_contact(Eigen::Index contact, Eigen::Index spheres) noexcept {
    return contact == 0 ? 0 : contact == spheres ? 2 : 1;
}

/// The load at these overlaps [m], one for each contact.
ContactLoad contact_load(const Chain& chain, const Eigen::ArrayXd& overlaps) noexcept;

/// Warnings about a scene before anything moves: lengths that suggest another unit, a disc that is no thin plate or
/// sags by more than half its thickness, contacts that the preload presses too deep, damping of another material. A
/// sentence each. @param scene has passed validate()
std::vector<std::string> validity_warnings(const Scene& scene, const Chain& chain);

/// Warns of a run that ends before its wave can reach the end of the chain: the earliest time when it could. Else nothing.
std::optional<std::string> late_wave_warning(const Scene& scene);

/// Warnings of a run that ends before sound can reach the hydrophone of a modal plate or some of output.points_m, whose pressure is 0 then,
/// or before a tone's burst has arrived there.
std::vector<std::string> late_sound_warnings(const Scene& scene);

/// Displacement of a plate's centre by the force at rest [m]; 0 of one on which that force is not balanced.
double sag_at_rest(const Chain& chain) noexcept;

/// Natural frequency of a plate, the lowest one, without fluid [Hz].
double plate_hz(const Chain& chain) noexcept;

/// Warns of a motion that bends a disc by more than half its thickness. @param deflection_m the largest displacement of its centre [m]
std::optional<std::string> bending_warning(const Scene& scene, double deflection_m);

/// Warnings about a motion: contacts that were pressed too deep.
std::vector<std::string> validity_warnings(const ContactLoad& load);

}  // namespace hertzline
