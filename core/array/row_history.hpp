#pragma once
// The past of a motion as rows of numbers at equal intervals, and integrals of it.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/plate/lagrange.hpp"
#include "core/plate/quadrature.hpp"

namespace hertzline {

/// Numbers that a scalar product of kernels takes at once.
inline constexpr Eigen::Index numbers_at_once = 16;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Weights of the newest rows in an integral of the past.
struct IntervalWeights {
    std::int64_t newest = 0;  ///< how many intervals ago the newest is
    /// [output][row, oldest first][number]; whole registers of numbers, with zeros before the oldest
    RowMajor weights;
};

/// The latest rows of numbers of equal size, any stretch of them in one piece of memory.
class RowHistory {
public:
    RowHistory(std::size_t numbers, std::size_t rows)
        : numbers_(numbers), rows_(rows), values_(2 * rows * numbers) {}

    void clear() noexcept { std::fill(values_.begin(), values_.end(), 0.0); }
    /// @param row not negative
    void put(std::int64_t row, const double* values) noexcept;
    /// `count` rows, of which that is the last; those before row 0 are zero.
    Eigen::Map<const Eigen::VectorXd> up_to(std::int64_t row, std::int64_t count) const noexcept;

private:
    std::size_t numbers_, rows_;
    std::vector<double> values_;
};

/// How many rows.
inline std::int64_t rows_of(const IntervalWeights& weights, Eigen::Index numbers) noexcept {
    return weights.weights.cols() / numbers;
}

/// The integral of a memory from its first to its last break with rows that lie at equal intervals, where the rows between are those of
/// the polynomial through the eight nearest. The memory may begin and end like a square root at each break.
/// @param at gives the memory at a time, [output][number]
template <class At>
IntervalWeights interval_weights(const std::vector<double>& breaks, double interval, Eigen::Index outputs,
                                 Eigen::Index numbers, At at) {
    constexpr std::size_t nodes = 10;
    constexpr auto stencil = static_cast<std::int64_t>(LagrangeWeights{}.size());
    const auto from = static_cast<std::int64_t>(std::floor(breaks.front() / interval));
    const auto to = static_cast<std::int64_t>(std::ceil(breaks.back() / interval));
    const auto base_of = [](std::int64_t cell) { return std::max<std::int64_t>(0, cell - lagrange_before); };
    IntervalWeights found;
    found.newest = base_of(from);
    std::int64_t rows = base_of(std::max(from, to - 1)) + stencil - found.newest;
    while (rows * numbers % numbers_at_once != 0) {
        ++rows;
    }
    found.weights = RowMajor::Zero(outputs, rows * numbers);
    for (std::int64_t cell = from; cell < to; ++cell) {
        std::vector<double> places{static_cast<double>(cell) * interval,
                                   static_cast<double>(cell + 1) * interval};
        places.insert(places.end(), breaks.begin(), breaks.end());
        std::sort(places.begin(), places.end());
        for (std::size_t i = 0; i + 1 < places.size(); ++i) {
            const double a = std::max({places[i], breaks.front(), static_cast<double>(cell) * interval});
            const double b =
                std::min({places[i + 1], breaks.back(), static_cast<double>(cell + 1) * interval});
            if (!(b > a)) {
                continue;
            }
            each_node<nodes>(0, 1, [&](double x, double weight) {
                const SmoothStep step = smooth_step(x);
                const double time = a + (b - a) * step.value;
                const std::int64_t base = base_of(cell);
                const LagrangeWeights shares =
                    lagrange(time / interval - static_cast<double>(base + lagrange_before));
                const Eigen::MatrixXd memory = weight * (b - a) * step.slope * at(time);
                for (std::int64_t k = 0; k < stencil; ++k) {
                    const std::int64_t row = rows - 1 - (base + k - found.newest);
                    found.weights.middleCols(row * numbers, numbers) +=
                        shares[static_cast<std::size_t>(k)] * memory;
                }
            });
        }
    }
    return found;
}

}  // namespace hertzline
