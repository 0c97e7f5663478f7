#include "core/plate/exact_plate.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace hertzline {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
constexpr double two_pi = 2 * std::numbers::pi;

double disc_area(const PlateParameters& p) noexcept {
    return std::numbers::pi * p.radius_m * p.radius_m;
}

}  // namespace

ExactPlate::ExactPlate(const PlateParameters& parameters)
    : p_(parameters),
      discs_(disc_modes(p_)),
      modes_(dry_modes(p_)),
      shapes_(discs_),
      on_axis_(PointSound(shapes_, 0, p_.hydrophone_m / p_.radius_m), ka(p_.band_hz)) {
    const auto size = static_cast<Index>(discs_.size());
    added_ = Eigen::MatrixXd::Zero(size, size);
    if (p_.load != FluidLoad::none) {
        added_ = two_pi * p_.fluid.density_kg_per_m3 * std::pow(p_.radius_m, 3) * added_mass(discs_);
    }
    if (p_.load == FluidLoad::radiation) {
        radiation_.emplace(discs_, ka(p_.band_hz));
    }
    find_wet_frequencies();
}

double ExactPlate::ka(double frequency_hz) const noexcept {
    return two_pi * frequency_hz * p_.radius_m / p_.fluid.sound_speed_m_per_s;
}

/// Mass matrix of the modes, without the fluid [kg].
Eigen::MatrixXd ExactPlate::masses() const {
    Eigen::MatrixXd mass = 0 * added_;
    for (Index n = 0; n < mass.rows(); ++n) {
        mass(n, n) = modes_[static_cast<std::size_t>(n)].mass_kg;
    }
    return mass;
}

Eigen::VectorXd ExactPlate::mobility_at_once() const {
    const Eigen::MatrixXd inverse = mode_mobilities_at_once();
    return inverse * Eigen::VectorXd::Ones(inverse.rows());
}

Eigen::MatrixXd ExactPlate::mode_mobilities_at_once() const {
    // a fluid that radiates gives way at once
    const Eigen::MatrixXd mass =
        p_.load == FluidLoad::added_mass ? Eigen::MatrixXd(masses() + added_) : masses();
    return mass.inverse();
}

Eigen::VectorXcd ExactPlate::mobilities(double frequency_hz) const {
    return hertzline::mode_mobilities(modes_, fluid_impedance(frequency_hz), frequency_hz);
}

Eigen::MatrixXcd ExactPlate::mode_mobilities(double frequency_hz) const {
    return mode_impedances(modes_, fluid_impedance(frequency_hz), frequency_hz).inverse();
}

Eigen::MatrixXcd ExactPlate::fluid_impedance(double frequency_hz) const {
    Eigen::MatrixXcd impedance = Complex(0, two_pi * frequency_hz) * added_;
    if (radiation_) {
        impedance = p_.fluid.density_kg_per_m3 * p_.fluid.sound_speed_m_per_s * disc_area(p_) *
                    (*radiation_)(ka(frequency_hz));
    }
    return impedance;
}

Eigen::VectorXcd ExactPlate::pressures(double frequency_hz) const {
    return on_axis_(ka(frequency_hz));
}

void ExactPlate::find_wet_frequencies() {
    Eigen::MatrixXd stiffness = 0 * added_;
    for (Index n = 0; n < stiffness.rows(); ++n) {
        stiffness(n, n) = modes_[static_cast<std::size_t>(n)].stiffness_n_per_m;
    }
    const Eigen::VectorXd squares = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
                                        stiffness, masses() + added_, Eigen::EigenvaluesOnly)
                                        .eigenvalues();
    for (Index n = 0; n < squares.size(); ++n) {
        PlateMode& mode = modes_[static_cast<std::size_t>(n)];
        mode.wet_hz = std::sqrt(squares[n]) / two_pi;
        constexpr double by_radiation = 0.01;
        mode.half_width = p_.load == FluidLoad::radiation
                              ? by_radiation
                              : 0.5 * mode.loss_kg_per_s / mode.stiffness_n_per_m * std::sqrt(squares[n]);
    }
}

Eigen::MatrixXcd mode_impedances(const std::vector<PlateMode>& modes, const Eigen::MatrixXcd& fluid,
                                 double frequency_hz) {
    const double omega = two_pi * frequency_hz;
    Eigen::MatrixXcd all = fluid;
    for (Index n = 0; n < all.rows(); ++n) {
        const PlateMode& mode = modes[static_cast<std::size_t>(n)];
        all(n, n) += Complex(mode.loss_kg_per_s, omega * mode.mass_kg - mode.stiffness_n_per_m / omega);
    }
    return all;
}

Eigen::VectorXcd mode_mobilities(const std::vector<PlateMode>& modes, const Eigen::MatrixXcd& impedance,
                                 double frequency_hz) {
    const Eigen::MatrixXcd all = mode_impedances(modes, impedance, frequency_hz);
    return all.partialPivLu().solve(Eigen::VectorXcd::Ones(all.rows()));
}

}  // namespace hertzline
