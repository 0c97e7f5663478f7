#pragma once
// The parameters of a modal plate, and its modes.

#include <vector>

#include "core/plate/disc_modes.hpp"
#include "core/plate/plate_section.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// All that a plate's response depends on, in SI units.
struct PlateParameters {
    PlateSection section{};
    Fluid fluid{};
    double radius_m = 0;
    int modes = 1;
    FluidLoad load = FluidLoad::none;
    double hydrophone_m = 0;
    double contact_hz = 0;  ///< frequency of the fastest contacts, or a little more
    double band_hz = 0;     ///< up to where the response has to be right at least

    /// Sound's way from the plate to the hydrophone [s].
    double travel_s() const noexcept { return hydrophone_m / fluid.sound_speed_m_per_s; }
    bool operator==(const PlateParameters&) const = default;
};

/// One mode of the disc, in a vacuum and in the fluid.
struct PlateMode {
    double mass_kg = 0;
    double stiffness_n_per_m = 0;
    double loss_kg_per_s = 0;  ///< modal dashpot, eta K / w
    double mean = 0;           ///< mean of the shape over the disc
    double dry_hz = 0;         ///< natural frequency in a vacuum
    double wet_hz = 0;         ///< with the fluid's added mass
    double half_width = 0;     ///< of the wet resonance over its frequency, roughly
    double kb_h =
        0;  ///< bending wave's number times thickness: less than 1.5 in a thin plate, 3 in a thick one
};

/// The shapes of the modes.
std::vector<DiscMode> disc_modes(const PlateParameters& parameters);

/// The modes in a vacuum: all but wet_hz and half_width.
std::vector<PlateMode> dry_modes(const PlateParameters& parameters);

/// The highest mode's natural frequency in a vacuum [Hz].
double highest_dry_hz(const PlateParameters& parameters);

}  // namespace hertzline
