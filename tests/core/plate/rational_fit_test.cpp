// Vector fitting: rational functions are found, and exact constraints hold.

#include "core/plate/rational_fit.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace hertzline {
namespace {

using Complex = std::complex<double>;

const Poles true_poles{{-0.01, 0.2}, {-0.3, 0.6}, {-0.05, 0.9}};

Responses sampled(const std::vector<Eigen::VectorXcd>& functions) {
    constexpr Eigen::Index points = 200;
    Responses responses{Eigen::VectorXcd(points),
                        Eigen::MatrixXcd(points, static_cast<Eigen::Index>(functions.size())),
                        Eigen::MatrixXd::Ones(points, static_cast<Eigen::Index>(functions.size()))};
    for (Eigen::Index i = 0; i < points; ++i) {
        responses.s[i] = Complex(0, (static_cast<double>(i) + 1) / points);
        for (std::size_t f = 0; f < functions.size(); ++f) {
            responses.values(i, static_cast<Eigen::Index>(f)) =
                value_at(true_poles, functions[f], responses.s[i]);
        }
    }
    return responses;
}

TEST(RationalFit, FindsThePolesOfARationalFunction) {
    const Eigen::VectorXcd one{{Complex(1, 0.5), Complex(-0.3, 0.2), Complex(0.1, 0)}};
    const Eigen::VectorXcd other{{Complex(-0.2, 0.1), Complex(1, 1), Complex(0.4, -0.7)}};
    const Responses responses = sampled({one, other});
    Poles poles{{-0.003, 0.3}, {-0.005, 0.5}, {-0.01, 1.0}};
    for (int round = 0; round < 8; ++round) {
        poles = relocated(poles, responses, 2);
    }
    for (const Complex& pole : true_poles) {
        double nearest = 1;
        for (const Complex& found : poles) {
            nearest = std::min(nearest, std::abs(found - pole));
        }
        EXPECT_LT(nearest, 1e-9) << pole;
    }
    const Eigen::VectorXcd found =
        residues(poles, responses.s, responses.values.col(0), responses.weights.col(0), {});
    for (Eigen::Index i = 0; i < responses.s.size(); ++i) {
        EXPECT_LT(std::abs(value_at(poles, found, responses.s[i]) - responses.values(i, 0)), 1e-8);
    }
}

TEST(RationalFit, PolesStayStableAndNear) {
    // a pure delay has no poles at all
    Responses responses = sampled({Eigen::VectorXcd::Ones(3)});
    for (Eigen::Index i = 0; i < responses.s.size(); ++i) {
        responses.values(i, 0) = std::exp(-20.0 * responses.s[i]);
    }
    Poles poles{{-0.1, 0.2}, {-0.1, 0.4}, {-0.1, 0.6}, {-0.1, 0.8}};
    for (int round = 0; round < 10; ++round) {
        poles = relocated(poles, responses, 1.5);
        for (const Complex& pole : poles) {
            EXPECT_LT(pole.real(), 0);
            EXPECT_GE(pole.imag(), 0);
            EXPECT_LE(std::abs(pole), 1.5 * (1 + 1e-12));
        }
    }
}

TEST(RationalFit, MomentsAreExact) {
    const Responses responses = sampled({Eigen::VectorXcd::Ones(3)});
    const Poles poles{{-0.1, 0.3}, {-0.2, 0}, {-0.1, 0.8}};
    const std::vector<Moment> moments{{0, 0.7}, {-1, 0}, {-2, -3.5}};
    const Eigen::VectorXcd found =
        residues(poles, responses.s, responses.values.col(0), responses.weights.col(0), moments);
    for (const Moment& moment : moments) {
        double sum = 0;
        for (std::size_t n = 0; n < poles.size(); ++n) {
            sum += 2 * (found[static_cast<Eigen::Index>(n)] * std::pow(poles[n], moment.power)).real();
        }
        EXPECT_NEAR(sum, moment.value, 1e-10) << moment.power;
    }
}

}  // namespace
}  // namespace hertzline
