#pragma once
// Sound at one point of the fluid beside a vibrating disc in a rigid baffle. In numbers without units: lengths in units of the disc's
// radius a, times in units of a/c.
//
// A velocity of mode n with the derivative q''(t) makes the pressure rho c int h(s) q''(t - s) ds. h is the mean of the mode's shape over
// the arc of the circle about the point's foot from which sound arrives after s (P. R. Stepanishen, J. Acoust. Soc. Am. 49 (1971) 1629;
// docs/model.md, section 10).

#include <complex>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "core/plate/disc_modes.hpp"

namespace hertzline {

/// Shapes of the modes by Chebyshev's polynomials in the square of the radius, in which they are entire.
class ShapeTable {
public:
    explicit ShapeTable(const std::vector<DiscMode>& modes);
    /// A value for each mode, then zeros: a few registers.
    using Shapes = Eigen::Array<double, 8, 1>;
    static_assert(max_disc_modes <= Shapes::SizeAtCompileTime);

    Eigen::Index modes() const noexcept { return modes_; }
    /// @param square of a radius from 0 to 1
    Shapes operator()(double square) const;

private:
    Eigen::Index modes_;
    Eigen::Array<double, Shapes::SizeAtCompileTime, Eigen::Dynamic> coefficients_;  ///< [mode][degree]
};

class PointSound {
public:
    /// @param shapes outlives the object @param from_axis, from_plane distances of the point, not negative @param delay of the disc's motion
    PointSound(const ShapeTable& shapes, double from_axis, double from_plane, double delay = 0);

    Eigen::Index modes() const noexcept { return shapes_.get().modes(); }
    /// Times of the first and the last sound.
    double first() const noexcept { return breaks_.front(); }
    double last() const noexcept { return breaks_.back(); }
    /// Times from first() to last() between which h is smooth.
    const std::vector<double>& breaks() const noexcept { return breaks_; }
    /// h of each mode, first() <= time <= last().
    Eigen::ArrayXd operator()(double time) const;

private:
    std::reference_wrapper<const ShapeTable> shapes_;
    double from_axis_, from_plane_, delay_;
    std::vector<double> breaks_;
};

/// The sound at one point of several discs that move alike.
class SoundSum {
public:
    /// @param sounds of the discs, at least one
    explicit SoundSum(std::vector<PointSound> sounds);

    // as of a PointSound
    double first() const noexcept { return breaks_.front(); }
    double last() const noexcept { return breaks_.back(); }
    const std::vector<double>& breaks() const noexcept { return breaks_; }
    Eigen::ArrayXd operator()(double time) const;

private:
    std::vector<PointSound> sounds_;
    std::vector<double> breaks_;
};

/// Groups of those whose sounds overlap or follow each other closely: the silence between two groups takes no time to compute.
std::vector<SoundSum> grouped(std::vector<PointSound> sounds);

/// Its spectrum: pressure per rho c and per velocity of each mode, with time as exp(i w t) and counted from the first sound,
/// i k int h(s) exp(-i k (s - first)) ds.
class PointSpectrum {
public:
    /// @param max_ka largest k a
    PointSpectrum(const PointSound& sound, double max_ka);
    Eigen::VectorXcd operator()(double ka) const;

private:
    std::vector<double> times_;  ///< of the nodes after the first sound
    Eigen::MatrixXd values_;     ///< times the nodes' weights, [mode][node]
};

}  // namespace hertzline
