#include "core/plate/disc_pair.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/plate/chebyshev.hpp"
#include "core/plate/point_sound.hpp"
#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

using Eigen::Index;

constexpr std::size_t arc_nodes = 32;
constexpr std::size_t lens_nodes = 24;
constexpr int memory_degrees = 56;

/// Odd polynomials of Chebyshev that a correlation takes: its waves are twice as short as those of the highest mode.
constexpr int odd_degrees(Index modes) noexcept {
    return 16 + 7 * static_cast<int>(modes);
}

/// T_1, T_3, T_5, ... at -1 <= t <= 1.
Eigen::VectorXd odd_polynomials(Index count, double t) {
    Eigen::VectorXd all(count);
    const double twice = 2 * (2 * t * t - 1);
    all[0] = t;
    double before = t;  // T_-1
    for (Index k = 1; k < count; ++k) {
        all[k] = twice * all[k - 1] - before;
        before = all[k - 1];
    }
    return all;
}

/// Coefficients of odd functions of t by them. @param at gives their values at 0 < t < 1
template <class Function>
Eigen::MatrixXd odd_chebyshev(int count, Index functions, Function at) {
    Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(functions, count);
    for (int i = 0; i < count; ++i) {
        const double t = std::cos(std::numbers::pi * (i + 0.5) / (2 * count));
        coefficients += (2.0 / count) * at(t) * odd_polynomials(count, t).transpose();
    }
    return coefficients;
}

/// First and second derivative of such a series.
struct Derivatives {
    Eigen::VectorXd first;
    Eigen::VectorXd second;
};
Derivatives derivatives(const Eigen::MatrixXd& odd, double t) {
    const Index count = 2 * odd.cols();
    Eigen::VectorXd value(count);
    Eigen::VectorXd first(count);
    Eigen::VectorXd second(count);
    value[0] = 1;
    value[1] = t;
    first[0] = second[0] = second[1] = 0;
    first[1] = 1;
    for (Index q = 2; q < count; ++q) {
        value[q] = 2 * t * value[q - 1] - value[q - 2];
        first[q] = 2 * value[q - 1] + 2 * t * first[q - 1] - first[q - 2];
        second[q] = 4 * first[q - 1] + 2 * t * second[q - 1] - second[q - 2];
    }
    Derivatives at{Eigen::VectorXd::Zero(odd.rows()), Eigen::VectorXd::Zero(odd.rows())};
    for (Index k = 0; k < odd.cols(); ++k) {
        at.first += first[2 * k + 1] * odd.col(k);
        at.second += second[2 * k + 1] * odd.col(k);
    }
    return at;
}

/// phi_m(x) phi_n(x - r) over the half of the lens that is nearer to the rim of the first disc.
Eigen::MatrixXd half_lens(const ShapeTable& shapes, double r) {
    const Index count = shapes.modes();
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count);
    const double width = 1 - r / 2;
    each_node<lens_nodes>(0, 1, [&](double root, double weight) {
        const double x = 1 - width * root * root;
        const double height = std::sqrt(std::max(0.0, (1 - x) * (1 + x)));
        each_node<lens_nodes>(0, height, [&](double y, double weight_y) {
            const ShapeTable::Shapes here = shapes(std::min(1.0, x * x + y * y));
            const ShapeTable::Shapes there = shapes(std::min(1.0, (x - r) * (x - r) + y * y));
            sum.noalias() += (4 * weight_y * weight * width * root) * here.head(count).matrix() *
                             there.head(count).matrix().transpose();
        });
    });
    return sum;
}

Eigen::VectorXd correlation_at(const ShapeTable& shapes, double r) {
    const Eigen::MatrixXd half = half_lens(shapes, r);
    const Index modes = shapes.modes();
    Eigen::VectorXd all(pairs_of(modes));
    for (Index n = 0; n < modes; ++n) {
        for (Index m = 0; m <= n; ++m) {
            all[pair_of(m, n)] = half(m, n) + half(n, m);
        }
    }
    return all;
}

}  // namespace

/// A is an odd function of t = sqrt(1 - r/2), as the lens shows whose width is t^2 and whose height goes with t. A' = -A_t/(4 t), and
/// A'' = (A_tt - A_t/t)/(16 t^2).
ModeCorrelation::ModeCorrelation(const std::vector<DiscMode>& modes)
    : modes_(static_cast<Index>(modes.size())) {
    const Index pairs = pairs_of(modes_);
    const int degrees = odd_degrees(modes_);
    const ShapeTable shapes(modes);
    const auto r_of = [](double t) { return 2 * (1 - t) * (1 + t); };
    const Eigen::MatrixXd value =
        odd_chebyshev(degrees, pairs, [&](double t) { return correlation_at(shapes, r_of(t)); });
    second_ = odd_chebyshev(degrees, pairs, [&](double t) -> Eigen::VectorXd {
        const Derivatives at = derivatives(value, t);
        return (at.second - at.first / t) / (16 * t * t);
    });
    first_over_r_ = odd_chebyshev(degrees, pairs, [&](double t) -> Eigen::VectorXd {
        return -derivatives(value, t).first / (4 * t * r_of(t));
    });
}

void ModeCorrelation::add_curvature(double r, double u, double weight, Eigen::VectorXd& sum) const {
    const Eigen::VectorXd at = odd_polynomials(second_.cols(), std::sqrt(std::max(0.0, 1 - r / 2)));
    sum.noalias() += weight * u * u * (second_ * at);
    sum.noalias() += weight * (1 - u * u) * (first_over_r_ * at);
}

PairMemory::PairMemory(const ModeCorrelation& correlation, double distance)
    : distance_(distance), modes_(correlation.modes()) {
    const double d = distance;
    const Index pairs = pairs_of(modes_);
    const auto at = [&](double s) {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(pairs);
        const double end = std::acos(std::clamp((s * s + d * d - 4) / (2 * s * d), -1.0, 1.0));
        each_node<arc_nodes>(0, end, [&](double angle, double weight) {
            const double half = std::sin(0.5 * angle);
            const double r = std::sqrt((s - d) * (s - d) + 4 * s * d * half * half);
            const double u = r > 0 ? (s - d * std::cos(angle)) / r : 1;
            correlation.add_curvature(std::min(r, 2.0), u, weight / std::numbers::pi, sum);
        });
        return sum;
    };
    for (std::size_t half = 0; half < halves_.size(); ++half) {
        const double from = half == 0 ? d - 2 : d;
        halves_[half] = chebyshev(memory_degrees, pairs, [&](double x) { return at(from + 2 * x); });
    }
}

Eigen::VectorXd PairMemory::operator()(double time) const {
    const double since = time - first();
    if (!(since > 0 && since < 4)) {
        return Eigen::VectorXd::Zero(halves_[0].rows());
    }
    const std::size_t half = since < 2 ? 0 : 1;
    return chebyshev_sum(halves_[half], std::clamp((since - (half == 0 ? 0 : 2)) / 2, 0.0, 1.0));
}

Eigen::MatrixXcd PairMemory::impedance(double ka) const {
    constexpr std::size_t nodes = 24;
    const int panels = 4 + static_cast<int>(ka / 4);
    Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(halves_[0].rows());
    for (int panel = 0; panel < 2 * panels; ++panel) {
        const double step = 2.0 / panels;
        each_node<nodes>(first() + panel * step, first() + (panel + 1) * step, [&](double s, double weight) {
            sum += weight * std::polar(1.0, -ka * s) * (*this)(s).cast<std::complex<double>>();
        });
    }
    Eigen::MatrixXcd all(modes_, modes_);
    for (Index m = 0; m < modes_; ++m) {
        for (Index n = 0; n < modes_; ++n) {
            all(m, n) = sum[pair_of(m, n)] / (std::complex<double>(0, ka) * std::numbers::pi);
        }
    }
    return all;
}

}  // namespace hertzline
