// The fluid's load on a disc and the sound in it, against an independent solver, the literature's limits and plain sums.

#include "core/plate/radiation.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/plate/quadrature.hpp"

namespace hertzline {
namespace {

using std::numbers::pi;

// a = 5 mm in water
constexpr double a = 5e-3;
constexpr double rho = 998;
constexpr double c = 1482;
constexpr double kg_per_s = rho * c * pi * a * a;
double ka(double frequency_hz) {
    return 2 * pi * frequency_hz * a / c;
}

TEST(Radiation, ResistanceOfTheFirstModeIsThatOfAnIndependentSolver) {
    constexpr std::array<std::array<double, 2>, 6> known{
        {{36.5e3, 3.22}, {73e3, 11.17}, {146e3, 25.96}, {219e3, 27.20}, {292e3, 23.90}, {365e3, 22.71}}};
    for (const auto& [frequency, resistance] : known) {
        EXPECT_NEAR(kg_per_s * radiation_impedance(disc_modes(1), ka(frequency))(0, 0).real(), resistance,
                    0.006);
    }
}

TEST(Radiation, AddedMassesAreThoseOfAnIndependentSolver) {
    const Eigen::MatrixXd mass = 2 * pi * rho * a * a * a * added_mass(disc_modes(4));
    constexpr std::array milligrams{46.85, 11.03, 4.37, 2.29};
    for (Eigen::Index n = 0; n < 4; ++n) {
        EXPECT_NEAR(1e6 * mass(n, n), milligrams[static_cast<std::size_t>(n)], 0.006);
    }
}

TEST(Radiation, TheAddedMassOfTheFirstModeIsNearLambs) {
    // H. Lamb, Proc. R. Soc. A 98 (1920) 205: 0.6689 rho a/(rho_disc h) of the plate's own for his trial shape
    const double own = DiscMode(0).mass() * pi;  // of rho_disc h a^2
    const double added = 2 * pi * added_mass(disc_modes(1))(0, 0);
    EXPECT_NEAR(added / own, 0.6689, 0.025 * 0.6689);
}

TEST(Radiation, LowFrequenciesFeelTheAddedMass) {
    const auto modes = disc_modes(4);
    const Eigen::MatrixXcd zeta = radiation_impedance(modes, 1e-3);
    EXPECT_LT((zeta.imag() - 2e-3 * added_mass(modes)).norm(), 1e-5 * zeta.imag().norm());
}

TEST(Radiation, HighFrequenciesFeelPlaneWaves) {
    for (int n = 0; n < 4; ++n) {
        const auto modes = disc_modes(4);
        const double ratio =
            radiation_impedance(modes, 120)(n, n).real() / modes[static_cast<std::size_t>(n)].mass();
        EXPECT_NEAR(ratio, 1, 0.01) << n;
    }
}

DiscShear of_half_a_radius() {  // thickness; nu = 0.15
    return {.rotary = 0.25 / 12, .compliance = 0.25 / 4.25};
}

TEST(Radiation, HighFrequenciesFeelPlaneWavesOfThickDiscsAcrossTheirModes) {
    const auto modes = disc_modes(4, of_half_a_radius());
    const Eigen::MatrixXd resistance = radiation_impedance(modes, 150).real();
    Eigen::MatrixXd overlap(4, 4);
    for (Eigen::Index m = 0; m < 4; ++m) {
        for (Eigen::Index n = 0; n < 4; ++n) {
            overlap(m, n) = 2 * integral<40>(0, 1, [&](double r) {
                                return r * modes[static_cast<std::size_t>(m)].shape(r) *
                                       modes[static_cast<std::size_t>(n)].shape(r);
                            });
        }
    }
    EXPECT_LT((resistance - overlap).norm(), 0.01 * overlap.norm());
    const Eigen::MatrixXd diagonal = overlap.diagonal().asDiagonal();
    EXPECT_GT((overlap - diagonal).norm(), 0.05 * overlap.norm());  // the modes' shapes are not orthogonal
}

TEST(Radiation, TheSlopeAtTheRimOfAThickDiscIsSummedToTheEnd) {
    // int Phi Phi dq by many panels: the rest falls like q^-4
    const auto modes = disc_modes(4, of_half_a_radius());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(4, 4);
    for (int panel = 0; panel < 1000; ++panel) {
        each_node<20>(6.0 * panel, 6.0 * (panel + 1), [&](double q, double weight) {
            Eigen::Vector4d phi;
            for (Eigen::Index n = 0; n < 4; ++n) {
                phi[n] = modes[static_cast<std::size_t>(n)].transform(q, ::j0(q), ::j1(q));
            }
            sum += weight * phi * phi.transpose();
        });
    }
    EXPECT_LT((added_mass(modes) - sum).norm(), 1e-10 * sum.norm());
}

TEST(Radiation, NeverGivesEnergyBack) {
    const auto modes = disc_modes(max_disc_modes);
    for (int i = 0; i < 33; ++i) {
        const double k = 0.01 * std::pow(1.3, i);  // up to 44
        const Eigen::MatrixXd resistance = radiation_impedance(modes, k).real();
        const Eigen::VectorXd values =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(resistance).eigenvalues();
        EXPECT_GE(values.minCoeff(), -1e-12 * values.maxCoeff()) << k;
    }
}

TEST(Radiation, WhatIsFeltOnTheFaceIsHeardFarAway) {
    // far away p = i w rho exp(-i k r)/r sum V Phi(k sin theta) (Rayleigh): its intensity over the hemisphere is the
    // resistance, in units of rho c pi a^2
    const auto modes = disc_modes(3);
    const double k = ka(146e3);
    const Eigen::Vector3d velocities(1, -0.4, 0.3);
    const double heard = integral<60>(0, pi / 2, [&](double theta) {
        const double q = k * std::sin(theta);
        double sum = 0;
        for (int n = 0; n < 3; ++n) {
            sum += velocities[n] * modes[static_cast<std::size_t>(n)].transform(q, ::j0(q), ::j1(q));
        }
        return 2 * k * k * sum * sum * std::sin(theta);
    });
    const double felt = velocities.dot(radiation_impedance(modes, k).real() * velocities);
    EXPECT_NEAR(heard / felt, 1, 1e-9);
}

TEST(Radiation, TheTableIsAsGoodAsTheIntegral) {
    for (const DiscShear& shear : {DiscShear{}, of_half_a_radius()}) {
        const auto modes = disc_modes(4, shear);
        const ImpedanceTable table(modes, 32);
        for (const double k : {0.0, 1e-4, 0.3, 1.55, 7.0, 19.3, 31.99}) {
            EXPECT_LT((table(k) - radiation_impedance(modes, k)).norm(), 1e-10) << k;
        }
    }
}

}  // namespace
}  // namespace hertzline
