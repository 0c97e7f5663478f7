#pragma once
// The solitary wave of an undamped chain without preload, exactly and in Nesterenko's long-wave limit.
//
// A wave that runs by c spheres a unit of time without changing has overlaps r(x) with
//
//     c^2 r(x) = integral of r(y)^(3/2) L(x - y) dy,    L(z) = max(1 - |z|, 0)
//
// where x counts spheres from the crest and stiffness, mass and largest overlap are 1: the equations of
// motion, integrated twice (J. M. English and R. L. Pego, Proc. Amer. Math. Soc. 133 (2005) 1763). Where the
// wave is long, r = cos^4(sqrt(10) x / 5) with c = 2/sqrt(5), pi 5/sqrt(10) = 4.97 diameters from end to end
// (V. F. Nesterenko, Dynamics of Heterogeneous Materials, 2001, chapter 1).

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace hertzline::test {

/// Speed c in the long-wave limit, and the length from end to end [diameters].
inline const double nesterenko_speed = 2 / std::sqrt(5.0);
inline const double nesterenko_length = 5 * std::numbers::pi / std::sqrt(10.0);

class SolitaryWave {
public:
    /// Solves for r by repeated application of the integral, until r no longer changes.
    SolitaryWave() : overlaps_(2 * reach * grid + 1) {
        for (int i = 0; i < size(); ++i) {
            const double phase = (i - reach * grid) * spacing * std::numbers::pi / nesterenko_length;
            overlaps_[i] = std::abs(phase) < std::numbers::pi / 2 ? std::pow(std::cos(phase), 4) : 0;
        }
        for (int round = 0; round < 70; ++round) {
            const std::vector<double> next = integrated();
            speed_ = std::sqrt(next[reach * grid]);
            std::transform(next.begin(), next.end(), overlaps_.begin(),
                           [&](double r) { return r / next[reach * grid]; });
        }
    }

    /// Spheres passed in a unit of time sqrt(m/k) A^(-1/4), A the largest overlap.
    double speed() const noexcept { return speed_; }

    /// Returns the overlap of the contact at x diameters from the crest, in units of A.
    double overlap(double x) const noexcept {
        const double at = (x + reach) * grid;
        if (at < 0 || at >= size() - 1) {
            return 0;
        }
        const auto below = static_cast<std::size_t>(at);
        const double part = at - static_cast<double>(below);
        return (1 - part) * overlaps_[below] + part * overlaps_[below + 1];
    }

    /// Returns the velocity of the sphere whose left contact is at x, in units of A per unit of time:
    /// c v(x) = integral of r^(3/2) from x to x + 1, since c v' is the difference of the forces on it.
    double velocity(double x) const noexcept {
        double sum = 0;
        for (int i = 0; i <= grid; ++i) {
            sum += (i == 0 || i == grid ? 0.5 : 1) * std::pow(overlap(x + i * spacing), 1.5);
        }
        return sum * spacing / speed_;
    }

    /// Returns the length [diameters] over which the overlap exceeds a part of its peak.
    double length_above(double part) const noexcept {
        double x = 0;
        while (overlap(x) > part) {
            x += spacing / 16;
        }
        return 2 * x;
    }

private:
    static constexpr int grid = 128;  ///< points to a diameter
    static constexpr int reach = 8;   ///< diameters to either side; there r < 1e-100
    static constexpr double spacing = 1.0 / grid;

    int size() const noexcept { return static_cast<int>(overlaps_.size()); }

    std::vector<double> integrated() const {
        std::vector<double> forces(overlaps_.size());
        std::transform(overlaps_.begin(), overlaps_.end(), forces.begin(),
                       [](double r) { return r * std::sqrt(r); });
        std::vector<double> result(overlaps_.size());
        for (int i = 0; i < size(); ++i) {
            for (int j = std::max(0, i - grid); j <= std::min(size() - 1, i + grid); ++j) {
                result[i] += forces[j] * (1 - std::abs(i - j) * spacing) * spacing;
            }
        }
        return result;
    }

    std::vector<double> overlaps_;
    double speed_ = 0;
};

/// Returns the wave, computed once for all tests.
inline const SolitaryWave& solitary_wave() {
    static const SolitaryWave wave;
    return wave;
}

}  // namespace hertzline::test
