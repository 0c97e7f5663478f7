#pragma once
// The load of a fluid on a vibrating disc in a rigid baffle. In numbers without units: lengths in units of the disc's radius a, impedances in units of rho c pi a^2.

#include <complex>
#include <vector>

#include <Eigen/Core>

#include "core/plate/disc_modes.hpp"

namespace hertzline {

/// The radiation impedance between the modes, Z_mn = rho c pi a^2 zeta_mn(k a) with time as exp(i w t): zeta_mn = 2 k a int_0^inf
/// Phi_m(q) Phi_n(q) q dq / sqrt((k a)^2 - q^2), Phi the transforms (docs/model.md, section 10). @param ka from 0 on
Eigen::MatrixXcd radiation_impedance(const std::vector<DiscMode>& modes, double ka);

/// Its limit for low frequencies is that of a mass: 2 rho a^3 pi times this matrix, int_0^inf Phi_m Phi_n dq.
Eigen::MatrixXd added_mass(const std::vector<DiscMode>& modes);

/// The radiation impedance up to some k a, from a table: it is an entire function of k a, whose Chebyshev series falls off faster than
/// exponentially once it has 2 terms for each oscillation.
class ImpedanceTable {
public:
    ImpedanceTable(const std::vector<DiscMode>& modes, double max_ka);
    Eigen::MatrixXcd operator()(double ka) const;

private:
    double max_ka_;
    std::vector<Eigen::MatrixXcd> coefficients_;
};

}  // namespace hertzline
