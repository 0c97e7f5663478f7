#pragma once
// The physical plate: modes of a clamped disc with a fluid on one side, and the pressure in that fluid, as linear states that the force
// of the last contact drives (docs/model.md, section 10).

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/plate/plate_modes.hpp"
#include "core/plate/rational_fit.hpp"

namespace hertzline {

/// States y with y' = pole y + force, one of each conjugate pair. An output is 2 Re(sum of its residues times y). The pressure at the
/// hydrophone follows from the modes' velocities (solvers/sampling/plate_outputs.hpp).
struct PlateResponse {
    PlateParameters parameters;
    std::vector<PlateMode> modes;

    Poles poles;                                 ///< [rad/s]
    Eigen::VectorXcd centre_m;                   ///< displacement under the contact [m/(N s)]
    Eigen::VectorXcd centre_m_per_s;             ///< its velocity
    std::vector<Eigen::VectorXcd> mode_m;        ///< displacement of each mode
    std::vector<Eigen::VectorXcd> mode_m_per_s;  ///< its velocity
    double mobility = 0;  ///< acceleration under the contact per newton, at once [1/kg]

    double band_hz = 0;  ///< up to where it is fitted
    /// Relative error (L2) that the fit gives the answer to a contact's force: of the velocity, and of the pressure that follows from
    /// the modes.
    double velocity_error = 0;
    double pressure_error = 0;
    double fit_error() const noexcept { return std::max(velocity_error, pressure_error); }
    /// Least real part of the mobility under the contact over its size: passive when it is not negative.
    double least_resistance = 0;
};

/// Up to there the fluid's load and the sound are worked out: the largest wave number times the disc's radius.
inline constexpr double largest_ka = 300;

/// The response with that number of poles: the more, the further the fit reaches. The latest are kept: a second call costs nothing. @throws std::bad_alloc
std::shared_ptr<const PlateResponse> plate_response(const PlateParameters& parameters, int poles);

/// The velocity of each mode per force on each mode, by the same states: residues of the pairs of modes (disc_pair.hpp), and the
/// accelerations at once [1/kg].
struct ModeResponse {
    std::vector<Eigen::VectorXcd> m_per_s;
    Eigen::MatrixXd mobility;
    double error =
        0;  ///< relative (L2) of the worst of them to its mode's own, of the answer to forces that water passes on
};

/// The latest are kept, as of plate_response(). @throws std::bad_alloc
std::shared_ptr<const ModeResponse> mode_response(const PlateResponse& response);

/// As few poles as bring both errors below a share of the accuracy, in a passive fit; about as many as there may be if none do.
int poles_for(const PlateParameters& parameters, double accuracy);

/// The number of poles of a second fit, to compare motions with: 52 to 64, in a passive fit where there is one; nothing where none has a
/// smaller error. @param other_than the poles of the first fit; the second has four more or fewer at least
/// @param error that the second must be below @param place 0 or 1: one of two such fits
std::optional<int> fine_poles(const PlateParameters& parameters, int other_than, double error,
                              std::size_t place = 0);

}  // namespace hertzline
