#pragma once
// Chebyshev series of several functions on [0, 1].

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/plate/quadrature.hpp"

namespace hertzline {

/// Coefficients, [function][degree]. @param at gives the functions' values as a column
template <class Function>
Eigen::MatrixXd chebyshev(int degrees, Eigen::Index functions, Function at) {
    Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(functions, degrees);
    for (int i = 0; i < degrees; ++i) {
        const double angle = std::numbers::pi * (i + 0.5) / degrees;
        const Eigen::VectorXd values = at(0.5 * (1 + std::cos(angle)));
        for (int q = 0; q < degrees; ++q) {
            coefficients.col(q) += (q == 0 ? 1.0 : 2.0) / degrees * std::cos(q * angle) * values;
        }
    }
    return coefficients;
}

/// The sum of a series by Clenshaw's recurrence. @param t from -1 to 1 @param coefficient gives that of a degree @param zero of its type
template <class Value, class Coefficient>
Value clenshaw(Eigen::Index degrees, double t, Value zero, Coefficient coefficient) {
    Value next = zero;
    Value after = std::move(zero);
    for (Eigen::Index q = degrees; q-- > 1;) {
        const Value now = coefficient(q) + 2 * t * next - after;
        after = next;
        next = now;
    }
    return coefficient(0) + t * next - after;
}

/// @param x from 0 to 1
inline Eigen::VectorXd chebyshev_sum(const Eigen::MatrixXd& coefficients, double x) {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(coefficients.rows());
    return clenshaw(coefficients.cols(), 2 * x - 1, zero,
                    [&](Eigen::Index q) { return coefficients.col(q); });
}

/// Eight functions at most that are smooth between some places, and may begin and end there like square roots. Where they are steep the
/// table has more places of its own, as many as its integral needs.
class TableBetween {
public:
    static constexpr int most_functions = 8;
    using Values = Eigen::Array<double, most_functions, 1>;

    /// @param at gives the functions' values as a column of at most eight
    template <class Function>
    TableBetween(const std::vector<double>& breaks, Function at) {
        for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
            add(breaks[i], breaks[i + 1], 0, at);
        }
    }

    /// @param place between the first and the last break
    Values operator()(double place) const {
        const auto after = std::upper_bound(starts_.begin() + 1, starts_.end(), place);
        const auto i = static_cast<std::size_t>(after - starts_.begin()) - 1;
        const double part = std::clamp((place - starts_[i]) / (ends_[i] - starts_[i]), 0.0, 1.0);
        const Series& series = series_[i];
        const Values zero = Values::Zero();
        return clenshaw(series.cols(), inverse_smooth_step(part), zero,
                        [&](Eigen::Index q) { return series.col(q); });
    }

private:
    static constexpr int degrees = 40;
    using Series = Eigen::Array<double, most_functions, degrees>;

    template <class Function>
    void add(double from, double to, int depth, const Function& at) {
        constexpr int deepest = 12;
        constexpr double rounding = 1e-13;
        Eigen::Index functions = 0;
        const Eigen::MatrixXd found = chebyshev(degrees, most_functions, [&](double x) -> Eigen::VectorXd {
            const Eigen::VectorXd values = at(from + (to - from) * smooth_step(x).value);
            functions = values.size();
            Eigen::VectorXd padded = Eigen::VectorXd::Zero(most_functions);
            padded.head(functions) = values;
            return padded;
        });
        largest_ = std::max(largest_, found.cwiseAbs().maxCoeff());
        const double error = found.rightCols(4).cwiseAbs().maxCoeff();
        if (depth < deepest && error * std::min(1.0, to - from) > rounding * largest_) {
            add(from, 0.5 * (from + to), depth + 1, at);
            add(0.5 * (from + to), to, depth + 1, at);
            return;
        }
        starts_.push_back(from);
        ends_.push_back(to);
        series_.emplace_back(found.array());
    }

    double largest_ = 0;
    std::vector<double> starts_, ends_;
    std::vector<Series> series_;
};

}  // namespace hertzline
