#include "core/plate/radiation.hpp"

#include <cmath>
#include <numbers>

#include "core/plate/chebyshev.hpp"
#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

constexpr std::size_t nodes = 24;
constexpr double per_panel = 8;  // argument of the transforms that a panel of nodes covers
constexpr double negligible =
    240;  // from here on Phi^2, which falls like q^-7 in a thin disc, adds less than 1e-13

Eigen::VectorXd transforms(const std::vector<DiscMode>& modes, double q) {
    Eigen::VectorXd phi(static_cast<Eigen::Index>(modes.size()));
    const double j0_q = ::j0(q);
    const double j1_q = ::j1(q);
    for (std::size_t n = 0; n < modes.size(); ++n) {
        phi[static_cast<Eigen::Index>(n)] = modes[n].transform(q, j0_q, j1_q);
    }
    return phi;
}

/// int weight(u) Phi Phi^T(q(u)) du over panels.
template <class Argument, class Weight>
Eigen::MatrixXd integral_of_products(const std::vector<DiscMode>& modes, double end, int panels, Argument q,
                                     Weight factor) {
    const auto size = static_cast<Eigen::Index>(modes.size());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
    for (int panel = 0; panel < panels; ++panel) {
        each_node<nodes>(end * panel / panels, end * (panel + 1) / panels, [&](double u, double weight) {
            const Eigen::VectorXd phi = transforms(modes, q(u));
            sum.noalias() += weight * factor(u) * phi * phi.transpose();
        });
    }
    return sum;
}

/// The mean of J0^2(q)/q^4 at q = sqrt(k^2 + u^2), int 1/(pi q^5) du for u from `negligible` on, by t = negligible/u.
double mean_tail(double ka) {
    return integral<nodes>(0, 1, [ka](double t) {
        return negligible * t * t * t / (std::numbers::pi * std::pow(std::hypot(negligible, ka * t), 5));
    });
}

/// int_0^inf Phi Phi^T(sqrt(k^2 + u^2)) du. A thick disc has a slope at its rim, and Phi falls like phi'(1) J0(q)/q^2.
Eigen::MatrixXd near_field(const std::vector<DiscMode>& modes, double ka) {
    Eigen::VectorXd rim(static_cast<Eigen::Index>(modes.size()));
    for (std::size_t n = 0; n < modes.size(); ++n) {
        rim[static_cast<Eigen::Index>(n)] = modes[n].slope_over_r(1);
    }
    const Eigen::MatrixXd sum = integral_of_products(
        modes, negligible, static_cast<int>(negligible / per_panel),
        [ka](double u) { return std::hypot(ka, u); }, [](double) { return 1.0; });
    return sum + mean_tail(ka) * rim * rim.transpose();
}

}  // namespace

/// Below k the square root is real: the substitution q = k sin(theta) takes its pole away. Above, q = sqrt(k^2 + u^2).
Eigen::MatrixXcd radiation_impedance(const std::vector<DiscMode>& modes, double ka) {
    const Eigen::MatrixXd far = integral_of_products(
        modes, 0.5 * std::numbers::pi, 2 + static_cast<int>(ka / per_panel),
        [ka](double theta) { return ka * std::sin(theta); },
        [ka](double theta) { return ka * std::sin(theta); });
    const Eigen::MatrixXd near = near_field(modes, ka);
    Eigen::MatrixXcd zeta(far.rows(), far.cols());
    zeta.real() = 2 * ka * far;
    zeta.imag() = 2 * ka * near;
    return zeta;
}

Eigen::MatrixXd added_mass(const std::vector<DiscMode>& modes) {
    return near_field(modes, 0);
}

ImpedanceTable::ImpedanceTable(const std::vector<DiscMode>& modes, double max_ka) : max_ka_(max_ka) {
    const int count = 32 + static_cast<int>(1.3 * max_ka);
    const auto angle = [count](int i) { return std::numbers::pi * (i + 0.5) / count; };
    std::vector<Eigen::MatrixXcd> values;
    values.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        values.push_back(radiation_impedance(modes, 0.5 * max_ka * (1 + std::cos(angle(i)))));
    }
    coefficients_.reserve(values.size());
    for (int n = 0; n < count; ++n) {
        Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(values[0].rows(), values[0].cols());
        for (int i = 0; i < count; ++i) {
            sum += std::cos(n * angle(i)) * values[static_cast<std::size_t>(i)];
        }
        coefficients_.emplace_back((n == 0 ? 1.0 : 2.0) / count * sum);
    }
}

Eigen::MatrixXcd ImpedanceTable::operator()(double ka) const {
    const Eigen::MatrixXcd zero = Eigen::MatrixXcd::Zero(coefficients_[0].rows(), coefficients_[0].cols());
    return clenshaw(std::ssize(coefficients_), 2 * ka / max_ka_ - 1, zero,
                    [this](Eigen::Index n) -> const Eigen::MatrixXcd& {
                        return coefficients_[static_cast<std::size_t>(n)];
                    });
}

}  // namespace hertzline
