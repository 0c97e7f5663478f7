#pragma once
// The load that discs beside each other in a rigid baffle are to one another. In numbers without units: lengths in units of the discs'
// radius a, times in units of a/c.
//
// Sound from all of one disc to all of the other, at distance d: a displacement q(t) of mode n is a force -rho c^2 a int K_mn(s) q(t - s) ds
// on mode m of the other, with a from d - 2 to d + 2 in s, since both are in one plane. K follows from the modes' correlation A_mn(r), the
// integral of phi_m(x) phi_n(x - r) over the plane, as the sound at a point does from the shape (docs/model.md, section 10.6):
//     K_mn(s) = 1/pi d^2/ds^2 int_0^theta A_mn(sqrt(s^2 + d^2 - 2 s d cos q)) dq,  theta where A ends, r = 2

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/plate/disc_modes.hpp"

namespace hertzline {

/// The pairs m <= n of modes, one after another: A and K are symmetric.
constexpr Eigen::Index pairs_of(Eigen::Index modes) noexcept {
    return modes * (modes + 1) / 2;
}
constexpr Eigen::Index pair_of(Eigen::Index m, Eigen::Index n) noexcept {
    return m <= n ? n * (n + 1) / 2 + m : m * (m + 1) / 2 + n;
}

/// The correlation of the modes' shapes: tables of A'' and A'/r, over the square root of 2 - r, in which they are smooth.
class ModeCorrelation {
public:
    explicit ModeCorrelation(const std::vector<DiscMode>& modes);

    Eigen::Index modes() const noexcept { return modes_; }
    /// Adds d^2/ds^2 of A(r(s)), where u = dr/ds.
    void add_curvature(double r, double u, double weight, Eigen::VectorXd& sum) const;

private:
    Eigen::Index modes_;
    Eigen::MatrixXd second_, first_over_r_;  ///< coefficients of odd polynomials of Chebyshev, [pair][degree]
};

/// The memory of the water between two discs.
class PairMemory {
public:
    /// @param distance of the centres, at least 2
    PairMemory(const ModeCorrelation& correlation, double distance);

    Eigen::Index modes() const noexcept { return modes_; }
    double first() const noexcept { return distance_ - 2; }
    double last() const noexcept { return distance_ + 2; }
    /// K of each pair of modes; 0 before first() and after last().
    Eigen::VectorXd operator()(double time) const;
    /// Z_mn/(rho c pi a^2), with time as exp(i w t): the spectrum of K over i k a and pi.
    Eigen::MatrixXcd impedance(double ka) const;

private:
    double distance_;
    Eigen::Index modes_;
    std::array<Eigen::MatrixXd, 2> halves_;  ///< before and after the distance, [pair][degree]
};

}  // namespace hertzline
