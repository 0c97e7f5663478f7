#include "core/plate/rational_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace hertzline {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;

bool is_real(const Complex& pole) noexcept {
    return pole.imag() == 0;
}

Index unknowns(const Poles& poles) noexcept {
    Index count = 0;
    for (const Complex& pole : poles) {
        count += is_real(pole) ? 1 : 2;
    }
    return count;
}

/// Visits the poles with the index of their first unknown: a residue, or real and imaginary part of a pair's.
template <class Visit>
void each_pole(const Poles& poles, Visit visit) {
    Index i = 0;
    for (const Complex& pole : poles) {
        visit(pole, i);
        i += is_real(pole) ? 1 : 2;
    }
}

/// The contribution of each unknown at each point.
Eigen::MatrixXcd fractions(const Poles& poles, const Eigen::VectorXcd& s) {
    Eigen::MatrixXcd basis(s.size(), unknowns(poles));
    each_pole(poles, [&](const Complex& pole, Index i) {
        const Eigen::ArrayXcd one = (s.array() - pole).inverse();
        if (is_real(pole)) {
            basis.col(i) = one;
            return;
        }
        const Eigen::ArrayXcd other = (s.array() - std::conj(pole)).inverse();
        basis.col(i) = one + other;
        basis.col(i + 1) = Complex(0, 1) * (one - other);
    });
    return basis;
}

/// Real parts above imaginary ones.
Eigen::MatrixXd stacked(const Eigen::MatrixXcd& rows) {
    Eigen::MatrixXd both(2 * rows.rows(), rows.cols());
    both << rows.real(), rows.imag();
    return both;
}

/// Solves by least squares. Columns may be almost the same.
Eigen::VectorXd solved(Eigen::MatrixXd rows, const Eigen::VectorXd& values) {
    const Eigen::VectorXd scale = rows.colwise().norm().cwiseMax(1e-300).cwiseInverse();
    rows *= scale.asDiagonal();
    return scale.cwiseProduct(
        Eigen::VectorXd(Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(rows).solve(values)));
}

/// The unknowns of sigma, whose poles are the present ones and whose zeros are better ones; last its value at infinity.
Eigen::VectorXd sigma(const Eigen::MatrixXcd& basis, const Responses& responses) {
    const Index size = basis.cols();
    const Index functions = responses.values.cols();
    Eigen::MatrixXd rows(functions * (size + 1) + 1, size + 1);
    for (Index j = 0; j < functions; ++j) {
        const auto weight = responses.weights.col(j).cast<Complex>().asDiagonal();
        const auto value = responses.values.col(j).asDiagonal();
        Eigen::MatrixXcd equations(basis.rows(), 2 * size + 1);
        equations << weight * basis, -(weight * (value * basis)), -(weight * responses.values.col(j));
        const Eigen::MatrixXd r = Eigen::HouseholderQR<Eigen::MatrixXd>(stacked(equations)).matrixQR();
        rows.middleRows(j * (size + 1), size + 1) =
            r.block(size, size, size + 1, size + 1).triangularView<Eigen::Upper>();
    }
    // sigma is not zero everywhere: its real part adds up to the number of points
    const auto points = static_cast<double>(basis.rows());
    const double weight = responses.values.cwiseProduct(responses.weights).norm() / points;
    rows.bottomRows(1) << weight * basis.real().colwise().sum(), weight * points;
    Eigen::VectorXd values = Eigen::VectorXd::Zero(rows.rows());
    values[values.size() - 1] = weight * points;
    return solved(std::move(rows), values);
}

}  // namespace

Poles relocated(const Poles& poles, const Responses& responses, double farthest) {
    const Index size = unknowns(poles);
    const Eigen::VectorXd found = sigma(fractions(poles, responses.s), responses);
    constexpr double least = 1e-8;
    const double at_infinity = std::copysign(std::max(std::abs(found[size]), least), found[size]);

    Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd input(size);
    each_pole(poles, [&](const Complex& pole, Index i) {
        companion(i, i) = pole.real();
        input[i] = is_real(pole) ? 1 : 2;
        if (!is_real(pole)) {
            companion.block<2, 2>(i, i) << pole.real(), pole.imag(), -pole.imag(), pole.real();
            input[i + 1] = 0;
        }
    });
    companion -= input * found.head(size).transpose() / at_infinity;

    Poles better;
    const Eigen::VectorXcd zeros = Eigen::EigenSolver<Eigen::MatrixXd>(companion, false).eigenvalues();
    for (const Complex& zero : zeros) {
        if (zero.imag() < 0) {
            continue;  // its conjugate is there
        }
        constexpr double least_decay = 1e-10;
        const double distance = std::abs(zero);
        const Complex stable(-std::max(std::abs(zero.real()), least_decay * distance), zero.imag());
        better.push_back(distance > farthest ? stable * (farthest / distance) : stable);
    }
    return better;
}

Eigen::VectorXcd residues(const Poles& poles, const Eigen::VectorXcd& s, const Eigen::VectorXcd& values,
                          const Eigen::VectorXd& weights, const std::vector<Moment>& moments) {
    const auto weight = weights.cast<Complex>().asDiagonal();
    const Eigen::MatrixXd rows = stacked(weight * fractions(poles, s));
    const Eigen::VectorXd wanted = stacked(weight * values);
    const auto count = static_cast<Index>(moments.size());

    Eigen::MatrixXd exact(count, rows.cols());
    Eigen::VectorXd exact_values(count);
    for (Index m = 0; m < count; ++m) {
        const Moment& moment = moments[static_cast<std::size_t>(m)];
        each_pole(poles, [&](const Complex& pole, Index i) {
            const Complex power = std::pow(pole, moment.power);
            exact(m, i) = is_real(pole) ? power.real() : 2 * power.real();
            if (!is_real(pole)) {
                exact(m, i + 1) = -2 * power.imag();
            }
        });
        const double scale = 1 / exact.row(m).norm();
        exact.row(m) *= scale;
        exact_values[m] = moment.value * scale;
    }
    // the solutions that have these moments: one of them, and the directions that change none
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(exact.transpose());
    const Eigen::MatrixXd q = qr.householderQ();
    const Eigen::VectorXd one =
        q.leftCols(count) *
        qr.matrixQR().topRows(count).triangularView<Eigen::Upper>().transpose().solve(exact_values);
    const Eigen::MatrixXd rest = q.rightCols(rows.cols() - count);
    const Eigen::VectorXd x = one + rest * solved(rows * rest, wanted - rows * one);

    Eigen::VectorXcd result(static_cast<Index>(poles.size()));
    Index n = 0;
    each_pole(poles, [&](const Complex& pole, Index i) {
        result[n++] = is_real(pole) ? Complex(0.5 * x[i], 0)
                                    : Complex(x[i], x[i + 1]);  // a real pole is its own conjugate
    });
    return result;
}

Complex value_at(const Poles& poles, const Eigen::VectorXcd& residues, Complex s) noexcept {
    Complex sum = 0;
    for (std::size_t n = 0; n < poles.size(); ++n) {
        const Complex residue = residues[static_cast<Index>(n)];
        sum += residue / (s - poles[n]) + std::conj(residue) / (s - std::conj(poles[n]));
    }
    return sum;
}

}  // namespace hertzline
