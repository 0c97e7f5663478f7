#pragma once
// Integrals of smooth functions, by Gauss and Legendre (Abramowitz and Stegun, 25.4.29).

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace hertzline {

/// Nodes in (-1, 1) and their weights.
template <std::size_t Count>
struct GaussNodes {
    std::array<double, Count> node{};
    std::array<double, Count> weight{};

    GaussNodes() noexcept {
        for (std::size_t i = 0; i < Count; ++i) {
            const auto n = static_cast<double>(Count);
            double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5));
            double slope = 1;
            for (int round = 0; round < 8; ++round) {
                double before = 0;
                double value = 1;
                for (std::size_t k = 1; k <= Count; ++k) {
                    const auto degree = static_cast<double>(k);
                    const double next = ((2 * degree - 1) * x * value - (degree - 1) * before) / degree;
                    before = value;
                    value = next;
                }
                slope = n * (x * value - before) / (x * x - 1);
                x -= value / slope;
            }
            node[i] = x;
            weight[i] = 2 / ((1 - x * x) * slope * slope);
        }
    }
};

/// The nodes of that number, computed once.
template <std::size_t Count>
const GaussNodes<Count>& gauss_nodes() noexcept {
    static const GaussNodes<Count> nodes;
    return nodes;
}

/// Calls visit(x, weight) for the nodes between two bounds.
template <std::size_t Count, class Visit>
void each_node(double from, double to, Visit visit) {
    const GaussNodes<Count>& nodes = gauss_nodes<Count>();
    const double half = 0.5 * (to - from);
    for (std::size_t i = 0; i < Count; ++i) {
        visit(from + half * (1 + nodes.node[i]), half * nodes.weight[i]);
    }
}

template <std::size_t Count, class Function>
double integral(double from, double to, Function function) {
    double sum = 0;
    each_node<Count>(from, to, [&](double x, double weight) { sum += weight * function(x); });
    return sum;
}

/// A substitution that takes square roots away from both ends of [0, 1].
struct SmoothStep {
    double value;
    double slope;
};
constexpr SmoothStep smooth_step(double x) noexcept {
    return {x * x * (3 - 2 * x), 6 * x * (1 - x)};
}
/// 2 x - 1 where the smooth step has that value: the middle root of a cubic.
inline double inverse_smooth_step(double value) noexcept {
    return -2 * std::sin(std::asin(1 - 2 * value) / 3);
}

}  // namespace hertzline
