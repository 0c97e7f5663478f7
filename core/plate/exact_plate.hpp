#pragma once
// The frequency response of a clamped disc with a fluid on one side, as exactly as its modes have it (docs/model.md, section 10).

#include <complex>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/plate/disc_modes.hpp"
#include "core/plate/plate_modes.hpp"
#include "core/plate/point_sound.hpp"
#include "core/plate/radiation.hpp"

namespace hertzline {

/// Mobilities: velocity per force on the plate's centre [m/(N s)], with time as exp(i w t).
class ExactPlate {
public:
    /// @throws std::bad_alloc
    explicit ExactPlate(const PlateParameters& parameters);

    const PlateParameters& parameters() const noexcept { return p_; }
    const std::vector<PlateMode>& modes() const noexcept { return modes_; }

    /// Mobility of each mode at a frequency [m/(N s)].
    Eigen::VectorXcd mobilities(double frequency_hz) const;
    /// Velocity of each mode per force on each mode [m/(N s)]; symmetric.
    Eigen::MatrixXcd mode_mobilities(double frequency_hz) const;
    /// Accelerations at the moment when a force sets in, per force: the inverse mass matrix times ones [1/kg].
    Eigen::VectorXd mobility_at_once() const;
    /// The same per force on each mode.
    Eigen::MatrixXd mode_mobilities_at_once() const;
    /// Pressure at the hydrophone per rho c and per velocity of each mode, without the travel time.
    Eigen::VectorXcd pressures(double frequency_hz) const;

private:
    double ka(double frequency_hz) const noexcept;
    Eigen::MatrixXcd fluid_impedance(double frequency_hz) const;
    Eigen::MatrixXd masses() const;
    void find_wet_frequencies();

    PlateParameters p_;
    std::vector<DiscMode> discs_;
    std::vector<PlateMode> modes_;
    ShapeTable shapes_;
    PointSpectrum on_axis_;
    Eigen::MatrixXd added_;  ///< masses of the fluid at low frequencies [kg]
    std::optional<ImpedanceTable> radiation_;
};

/// Impedance of the modes with that of the fluid between them [kg/s].
Eigen::MatrixXcd mode_impedances(const std::vector<PlateMode>& modes, const Eigen::MatrixXcd& fluid,
                                 double frequency_hz);

/// The exact mobilities of the modes at a frequency, velocity per force on the plate's centre [m/(N s)]: the poles are fitted to them.
/// @param impedance of the fluid between the modes [kg/s]
Eigen::VectorXcd mode_mobilities(const std::vector<PlateMode>& modes, const Eigen::MatrixXcd& impedance,
                                 double frequency_hz);

}  // namespace hertzline
