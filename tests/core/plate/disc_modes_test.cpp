// The vibrations of a clamped disc: roots, masses and transforms against the literature, other methods and plain sums.

#include "core/plate/disc_modes.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/plate/quadrature.hpp"

namespace hertzline {
namespace {

/// Returns R and S of a thick disc. @param kappa2 its shear correction
DiscShear shear_of(double thickness_over_radius, double nu, double kappa2 = 5.0 / 6) {
    const double square = thickness_over_radius * thickness_over_radius;
    return {.rotary = square / 12, .compliance = square / (6 * kappa2 * (1 - nu))};
}

double frequency_of(const DiscMode& mode) {
    return mode.root() * mode.root() * mode.slowing();
}

// from the thinnest discs of scenes to bars; the last modes of those from 0.3 on lie above the frequency at which a second wave propagates
constexpr std::array thicknesses{1e-3, 0.02, 0.1, 0.2, 0.31, 0.4, 0.5, 0.8, 1.3, 3.0, 20.0};
constexpr std::array ratios{-0.95, 0.0, 0.15, 0.35, 0.499};

TEST(DiscModes, RootsSolveTheirEquation) {
    // Leissa, Vibration of Plates, table 2.1: l^2 = 10.2158, 39.771, 89.104, 158.183, ...
    constexpr std::array squares{10.2158, 39.771, 89.104, 158.183};
    constexpr std::array roots{3.19622062, 6.30643705, 9.43949914, 12.57713064, 15.71643853};
    for (int n = 0; n < max_disc_modes; ++n) {
        const double l = DiscMode(n).root();
        // the change of sign lies within 1e-12 of the root
        const auto condition = [](double x) {
            return ::j0(x) * std::cyl_bessel_i(1.0, x) + ::j1(x) * std::cyl_bessel_i(0.0, x);
        };
        EXPECT_LT(condition(l * (1 - 1e-12)) * condition(l * (1 + 1e-12)), 0) << n;
        const auto i = static_cast<std::size_t>(n);
        if (i < squares.size()) {
            EXPECT_NEAR(l * l, squares[i], 1e-3 * squares[i]) << n;
        }
        if (i < roots.size()) {
            EXPECT_NEAR(l, roots[i], 1e-8) << n;
        }
    }
}

TEST(DiscModes, MassesAndMeansAreThoseOfTheShapes) {
    constexpr std::array masses{0.18283, 0.10190, 0.06754, 0.05066, 0.04053};
    constexpr std::array means{0.31160, -0.13127, 0.07362, -0.04856, 0.03506};
    for (std::size_t n = 0; n < masses.size(); ++n) {
        const DiscMode mode(static_cast<int>(n));
        EXPECT_NEAR(mode.mass(), masses[n], 6e-6) << n;
        EXPECT_NEAR(mode.mean(), means[n], 6e-6) << n;
    }
}

TEST(DiscModes, ShapesAreClampedAndOrthogonal) {
    for (int n = 0; n < max_disc_modes; ++n) {
        const DiscMode mode(n);
        EXPECT_DOUBLE_EQ(mode.shape(0), 1);
        EXPECT_NEAR(mode.shape(1), 0, 1e-12);
        EXPECT_NEAR((mode.shape(1) - mode.shape(1 - 1e-6)) / 1e-6, 0, 1e-3);
        for (int other = 0; other < n; ++other) {
            const DiscMode before(other);
            const double product =
                integral<40>(0, 1, [&](double r) { return r * mode.shape(r) * before.shape(r); });
            EXPECT_NEAR(product, 0, 1e-13) << n << ' ' << other;
        }
    }
}

TEST(DiscModes, TransformsAreTheIntegralsThatTheyStandFor) {
    for (const double thickness : {0.0, 0.1, 0.5, 1.3}) {
        for (const DiscMode& mode : disc_modes(max_disc_modes, shear_of(thickness, 0.15))) {
            for (const double k :
                 {0.0, 0.7, mode.root(), mode.root() * (1 + 1e-9), mode.root() + 1e-4, 11.0, 40.0}) {
                const double expected =
                    integral<80>(0, 1, [&](double r) { return r * mode.shape(r) * ::j0(k * r); });
                EXPECT_NEAR(mode.transform(k, ::j0(k), ::j1(k)), expected, 1e-10)
                    << thickness << ' ' << mode.root() << ' ' << k;
            }
        }
    }
}

TEST(ThickDisc, FrequenciesAreThoseOfTheTables) {
    // T. Irie, G. Yamada and S. Aomura, J. Appl. Mech. 47 (1980) 652: nu = 0.3, kappa^2 = pi^2/12
    struct Row {
        double thickness;
        std::array<double, 3> frequencies;
    };
    constexpr std::array rows{Row{0.05, {10.145, 38.855, 84.995}}, Row{0.1, {9.941, 36.479, 75.664}},
                              Row{0.2, {9.240, 30.211, 56.682}}};
    constexpr double pi = 3.141592653589793;
    for (const Row& row : rows) {
        for (int n = 0; n < 3; ++n) {
            const DiscMode mode(n, shear_of(row.thickness, 0.3, pi * pi / 12));
            EXPECT_NEAR(frequency_of(mode), row.frequencies[static_cast<std::size_t>(n)], 0.501e-3)
                << row.thickness << ' ' << n;
        }
    }
}

/// Returns the squares of the frequencies by the method of Rayleigh and Ritz, with polynomials that are 0 at the rim.
Eigen::VectorXd ritz_squares(const DiscShear& shear) {
    constexpr int terms = 16;
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(2 * terms, 2 * terms);
    Eigen::MatrixXd mass = stiffness;
    each_node<80>(0, 1, [&](double r, double weight) {
        // P_k(2 r^2 - 1) and its derivative by r
        Eigen::VectorXd slope = Eigen::VectorXd::Zero(2 * terms);  // w'
        Eigen::VectorXd w = slope, psi = slope, bending = slope;   // bending: psi' + psi/r
        double before = 0, p = 1, slope_before = 0, slope_p = 0;
        const double x = 2 * r * r - 1;
        const double rim = 1 - r * r;
        for (int k = 0; k < terms; ++k) {
            w[k] = rim * p;
            slope[k] = -2 * r * p + rim * slope_p * 4 * r;
            psi[terms + k] = r * rim * p;
            bending[terms + k] = 2 * rim * p - 2 * r * r * p + r * rim * slope_p * 4 * r;
            const double next = ((2 * k + 1) * x * p - k * before) / (k + 1);
            const double slope_next = ((2 * k + 1) * (p + x * slope_p) - k * slope_before) / (k + 1);
            before = std::exchange(p, next);
            slope_before = std::exchange(slope_p, slope_next);
        }
        const Eigen::VectorXd strain = slope + psi;
        stiffness +=
            weight * r * (strain * strain.transpose() / shear.compliance + bending * bending.transpose());
        mass += weight * r * (w * w.transpose() + shear.rotary * psi * psi.transpose());
    });
    const Eigen::VectorXd scale = mass.diagonal().cwiseSqrt().cwiseInverse();
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
               scale.asDiagonal() * stiffness * scale.asDiagonal(),
               scale.asDiagonal() * mass * scale.asDiagonal(), Eigen::EigenvaluesOnly)
        .eigenvalues();
}

TEST(ThickDisc, FrequenciesAreThoseOfRayleighAndRitz) {
    for (const double thickness : thicknesses) {
        for (const double nu : ratios) {
            const DiscShear shear = shear_of(thickness, nu);
            const Eigen::VectorXd expected = ritz_squares(shear);
            double before = 0;
            for (int n = 0; n < max_disc_modes; ++n) {
                const double frequency = frequency_of(DiscMode(n, shear));
                EXPECT_GT(frequency, before);
                before = frequency;
                // Ritz loses digits to the shear's stiffness in thin discs
                EXPECT_NEAR(frequency / std::sqrt(expected[n]), 1, 1e-10 + 2e-11 / (thickness * thickness))
                    << thickness << ' ' << nu << ' ' << n;
            }
        }
    }
}

TEST(ThickDisc, AScanFindsTheSameRootsAndNoOthers) {
    for (const double thickness : {0.05, 0.2, 0.5, 1.3, 3.0}) {
        const DiscShear shear = shear_of(thickness, 0.15);
        const auto modes = disc_modes(max_disc_modes, shear);
        // phi(1) = psi(1) = 0 with the two waves of a frequency
        const auto determinant = [&shear](double frequency) {
            const double r = shear.rotary, s = shear.compliance, l4 = frequency * frequency;
            const double root = std::sqrt((r - s) * (r - s) + 4 / l4);
            const double one = 0.5 * l4 * (r + s + root), two = 0.5 * l4 * (r + s - root);
            const double k = std::sqrt(one), q = std::sqrt(std::abs(two));
            const double tilt = two / (r * l4 - 1 / s) - 1, other_tilt = one / (r * l4 - 1 / s) - 1;
            const double c = two > 0 ? ::j0(q) : std::cyl_bessel_i(0.0, q);
            const double slope = two > 0 ? -q * ::j1(q) : q * std::cyl_bessel_i(1.0, q);
            return -tilt * k * ::j1(k) * c - other_tilt * slope * ::j0(k);
        };
        std::vector<double> found;
        const double highest = frequency_of(modes.back());
        constexpr int steps = 40000;
        double before = determinant(0.1);
        for (int i = 1; i <= steps; ++i) {
            const double frequency = 0.1 + (1.0001 * highest - 0.1) * i / steps;
            const double now = determinant(frequency);
            if (before * now < 0) {
                found.push_back(frequency);
            }
            before = now;
        }
        ASSERT_EQ(found.size(), modes.size()) << thickness;
        for (std::size_t n = 0; n < modes.size(); ++n) {
            EXPECT_NEAR(frequency_of(modes[n]), found[n], 1.1 * highest / steps) << thickness << ' ' << n;
        }
    }
}

TEST(ThickDisc, AThinOneIsItsLimit) {
    for (int n = 0; n < max_disc_modes; ++n) {
        const DiscMode thin(n);
        for (const double thickness : {1e-2, 1e-3, 1e-4, 1e-9}) {
            const DiscMode thick(n, shear_of(thickness, 0.15));
            const double small = 400 * thickness * thickness + 1e-12;
            EXPECT_NEAR(frequency_of(thick) / frequency_of(thin), 1, small);
            EXPECT_LE(frequency_of(thick), frequency_of(thin) * (1 + 1e-13));
            EXPECT_NEAR(thick.mass() / thin.mass(), 1, small);
            EXPECT_NEAR(thick.mean() / thin.mean(), 1, small);
            EXPECT_NEAR(thick.shape(0.4), thin.shape(0.4), small);
            EXPECT_NEAR(thick.slope_over_r(0.4), thin.slope_over_r(0.4), 20 * small);
            EXPECT_NEAR(thick.rotation(0.4), -0.4 * thin.slope_over_r(0.4), 20 * small);
            EXPECT_NEAR(thick.transform(7, ::j0(7), ::j1(7)), thin.transform(7, ::j0(7), ::j1(7)), small);
        }
    }
}

TEST(ThickDisc, ShapesAreClampedAndOrthogonalInTheirEnergy) {
    for (const double thickness : thicknesses) {
        const DiscShear shear = shear_of(thickness, 0.15);
        const auto modes = disc_modes(max_disc_modes, shear);
        for (std::size_t n = 0; n < modes.size(); ++n) {
            const DiscMode& mode = modes[n];
            EXPECT_NEAR(mode.shape(0), 1, 1e-12);
            double size = 0, turn = 0;
            for (int i = 0; i <= 20; ++i) {
                size = std::max(size, std::abs(mode.shape(0.05 * i)));
                turn = std::max(turn, std::abs(mode.rotation(0.05 * i)));
            }
            EXPECT_NEAR(mode.shape(1), 0, 1e-11 * size) << thickness << ' ' << n;
            EXPECT_NEAR(mode.rotation(1), 0, 1e-11 * turn) << thickness << ' ' << n;
            EXPECT_NEAR((mode.shape(0.700001) - mode.shape(0.699999)) / 2e-6, 0.7 * mode.slope_over_r(0.7),
                        1e-7 * turn);
            for (std::size_t other = 0; other <= n; ++other) {
                const DiscMode& before = modes[other];
                const double product = 2 * integral<64>(0, 1, [&](double r) {
                                           return r * (mode.shape(r) * before.shape(r) +
                                                       shear.rotary * mode.rotation(r) * before.rotation(r));
                                       });
                const double expected = other == n ? mode.mass() : 0;
                EXPECT_NEAR(product, expected, 1e-11 * std::sqrt(mode.mass() * before.mass()))
                    << thickness << ' ' << n << ' ' << other;
            }
        }
    }
}

}  // namespace
}  // namespace hertzline
