#pragma once
// Values between samples at equal intervals, by the polynomial through the eight nearest.

#include <array>
#include <cstddef>

namespace hertzline {

/// Samples before the interval in which the value lies, beside the one at its start.
inline constexpr int lagrange_before = 3;
/// Samples from its end on.
inline constexpr int lagrange_after = 4;
using LagrangeWeights = std::array<double, lagrange_before + 1 + lagrange_after>;

/// Weights of the samples, the first of which lies three intervals before. @param part of the interval, from 0 to 1
constexpr LagrangeWeights lagrange(double part) noexcept {
    LagrangeWeights weights{};
    for (std::size_t i = 0; i < weights.size(); ++i) {
        double weight = 1;
        for (std::size_t j = 0; j < weights.size(); ++j) {
            if (j != i) {
                const double node = static_cast<double>(j) - lagrange_before;
                weight *= (part - node) / (static_cast<double>(i) - static_cast<double>(j));
            }
        }
        weights[i] = weight;
    }
    return weights;
}

}  // namespace hertzline
