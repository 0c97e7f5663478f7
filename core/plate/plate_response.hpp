#pragma once
// The physical plate: modes of a clamped disc with a fluid on one side, and the pressure in that fluid, as linear states that the force
// of the last contact drives (docs/model.md, section 10).

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "core/plate/rational_fit.hpp"
#include "core/scene/scene.hpp"

namespace hertzline {

/// All that a plate's response hangs on, in SI units.
struct PlateParameters {
    Solid disc{};
    Fluid fluid{};
    double radius_m = 0;
    double thickness_m = 0;
    int modes = 1;
    double loss_factor = 0;
    FluidLoad load = FluidLoad::none;
    double hydrophone_m = 0;
    double band_hz = 0;  ///< up to where the response has to be right

    /// Sound's way from the plate to the hydrophone [s].
    double travel_s() const noexcept { return hydrophone_m / fluid.sound_speed_m_per_s; }
    bool operator==(const PlateParameters&) const = default;
};

/// One mode of the disc, and what the fluid makes of it.
struct PlateMode {
    double mass_kg = 0;
    double stiffness_n_per_m = 0;
    double loss_kg_per_s = 0;  ///< modal dashpot, eta K / w
    double mean = 0;           ///< mean of the shape over the disc
    double dry_hz = 0;         ///< natural frequency in a vacuum
    double wet_hz = 0;         ///< with the fluid's added mass
    double half_width = 0;     ///< of the wet resonance over its frequency, roughly
    double kb_h =
        0;  ///< bending wave's number times thickness: thin-plate theory asks for less than about 1.5
};

/// States y with y' = pole y + force, one of each conjugate pair. An output is 2 Re(sum of its residues times y). The pressure at the
/// hydrophone follows from the modes' velocities (solvers/plate_outputs.hpp).
struct PlateResponse {
    PlateParameters parameters;
    std::vector<PlateMode> modes;

    Poles poles;                                 ///< [rad/s]
    Eigen::VectorXcd centre_m;                   ///< displacement under the contact [m/(N s)]
    Eigen::VectorXcd centre_m_per_s;             ///< its velocity
    Eigen::VectorXcd face_m_per_s;               ///< mean velocity of the wet face
    std::vector<Eigen::VectorXcd> mode_m;        ///< displacement of each mode
    std::vector<Eigen::VectorXcd> mode_m_per_s;  ///< its velocity
    double mobility = 0;  ///< acceleration under the contact per newton, at once [1/kg]

    /// Largest error of the fit in the band, relative to the response there: of the velocity, and of the pressure that follows from the
    /// modes.
    double velocity_error = 0;
    double pressure_error = 0;
    /// Least real part of the mobility under the contact over its size: passive when it is not negative.
    double least_resistance = 0;
};

inline constexpr int min_plate_poles = 8;
inline constexpr int max_plate_poles = 80;

/// With so many poles. What was computed last is kept: a second call costs nothing. @throws std::bad_alloc
std::shared_ptr<const PlateResponse> plate_response(const PlateParameters& parameters, int poles);

/// The highest mode's natural frequency in a vacuum [Hz].
double highest_dry_hz(const PlateParameters& parameters);

/// As few poles as bring both errors below a share of the accuracy; as many as there may be if none do.
int poles_for(const PlateParameters& parameters, double accuracy);

/// The exact mobilities of the modes at a frequency, velocity per force on the plate's centre [m/(N s)]: what the poles are fitted to.
/// @param impedance of the fluid between the modes [kg/s]
Eigen::VectorXcd mode_mobilities(const std::vector<PlateMode>& modes, const Eigen::MatrixXcd& impedance,
                                 double frequency_hz);

}  // namespace hertzline
