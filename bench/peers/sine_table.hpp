#pragma once
// Sine and cosine to rounding, for the horn: the library's functions would take longer than all contact forces.

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace hertzline::bench {

class SineTable {
public:
    SineTable() {
        for (std::size_t i = 0; i < size; ++i) {
            const double angle = static_cast<double>(i) / per_radian;
            table_[i] = {std::sin(angle), std::cos(angle)};
        }
    }

    struct Pair {
        double sin, cos;
    };
    /// Rotates the entry below the angle by the rest. @param angle >= 0 [rad], within 2^31 entries
    Pair operator()(double angle) const {
        const auto n = static_cast<int>(angle * per_radian);
        const auto [s, c] = table_[static_cast<std::size_t>(n) % size];
        const double r = angle - n * (1 / per_radian);
        const double r2 = r * r;
        const double sin_r = r * (1 - r2 * (1.0 / 6 - r2 * (1.0 / 120 - r2 * (1.0 / 5040))));
        const double cos_r = 1 - r2 * (0.5 - r2 * (1.0 / 24 - r2 * (1.0 / 720 - r2 * (1.0 / 40320))));
        return {s * cos_r + c * sin_r, c * cos_r - s * sin_r};
    }

private:
    static constexpr std::size_t size = 256;
    static constexpr double per_radian = size / (2 * std::numbers::pi);
    std::array<Pair, size> table_;
};

}  // namespace hertzline::bench
