// The vibrations of a clamped disc: roots, masses and transforms against the literature and against plain sums.

#include "core/plate/disc_modes.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/plate/quadrature.hpp"

namespace hertzline {
namespace {

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
    for (int n = 0; n < max_disc_modes; ++n) {
        const DiscMode mode(n);
        for (const double k :
             {0.0, 0.7, mode.root(), mode.root() * (1 + 1e-9), mode.root() + 1e-4, 11.0, 40.0}) {
            const double expected =
                integral<80>(0, 1, [&](double r) { return r * mode.shape(r) * ::j0(k * r); });
            EXPECT_NEAR(mode.transform(k, ::j0(k), ::j1(k)), expected, 1e-10) << n << ' ' << k;
        }
    }
}

}  // namespace
}  // namespace hertzline
