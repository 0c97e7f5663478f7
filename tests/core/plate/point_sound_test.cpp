#include "core/plate/point_sound.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/plate/quadrature.hpp"

namespace hertzline {
namespace {

TEST(PointSound, PressureOnTheAxisIsRayleighsIntegral) {
    // p = i k rho c int v exp(-i k R)/(2 pi R) dS over the face, by many rings
    for (const double z : {0.02, 0.4, 2.0, 8.0}) {
        for (const double k : {0.2, 1.55, 7.7, 30.0}) {
            for (int n = 0; n < 4; ++n) {
                const DiscMode mode(n);
                std::complex<double> sum = 0;
                constexpr int rings = 400;
                for (int ring = 0; ring < rings; ++ring) {
                    // rings are narrow near the axis, where 1/R is steep
                    const double from = std::pow(static_cast<double>(ring) / rings, 2);
                    const double to = std::pow((ring + 1.0) / rings, 2);
                    each_node<8>(from, to, [&](double r, double weight) {
                        const double distance = std::hypot(r, z);
                        sum += weight * mode.shape(r) * std::polar(1.0, -k * (distance - z)) * r / distance;
                    });
                }
                const std::complex<double> expected = std::complex<double>(0, k) * sum;
                const ShapeTable shape({mode});
                EXPECT_LT(std::abs(PointSpectrum(PointSound(shape, 0, z), k)(k)[0] - expected),
                          1e-6 * std::abs(expected) + 1e-12)
                    << z << ' ' << k << ' ' << n;
            }
        }
    }
}

TEST(PointSound, IsThatOfAnIndependentProgramAtPointsOfAllKinds) {
    // tests/reference/README.md
    constexpr double a = 5e-3;
    constexpr double rho = 998;
    constexpr double c = 1482;
    const ShapeTable shapes(disc_modes(4));
    std::ifstream file(HERTZLINE_SOURCE_DIR "/tests/reference/modal/modes_field.csv");
    std::string line;
    std::getline(file, line);
    int points = 0;
    for (; std::getline(file, line); ++points) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream cells(line);
        double mode = 0;
        double f = 0;
        double s = 0;
        double z = 0;
        double re = 0;
        double im = 0;
        cells >> mode >> f >> s >> z >> re >> im;
        const double ka = 2 * std::numbers::pi * f * a / c;
        const PointSound sound(shapes, s / a, z / a);
        const std::complex<double> value = rho * c *
                                           PointSpectrum(sound, ka)(ka)[static_cast<int>(mode) - 1] *
                                           std::polar(1.0, -ka * sound.first());
        const std::complex<double> expected(re, im);
        EXPECT_LT(std::abs(value - expected), 1e-8 * std::abs(expected) + 1e-3) << line;
    }
    EXPECT_EQ(points, 192);
}

TEST(PointSound, FarAwayIsTheTransformOfTheShape) {
    // p = i k rho c v exp(-i k R)/R int phi J0(k r sin) r dr
    constexpr double distance = 1e4;
    const ShapeTable shapes(disc_modes(4));
    for (const double k : {0.5, 3.0, 9.0}) {
        for (const double angle : {0.0, 0.3, 0.9, 1.5}) {
            const PointSound sound(shapes, distance * std::sin(angle), distance * std::cos(angle));
            const Eigen::VectorXcd found =
                PointSpectrum(sound, k)(k) * std::polar(1.0, -k * (sound.first() - distance));
            for (int n = 0; n < 4; ++n) {
                const DiscMode mode(n);
                double transform = 0;
                each_node<32>(0, 1, [&](double r, double weight) {
                    transform += weight * mode.shape(r) * std::cyl_bessel_j(0, k * r * std::sin(angle)) * r;
                });
                const std::complex<double> expected = std::complex<double>(0, k * transform / distance);
                EXPECT_LT(std::abs(found[n] - expected), 1e-3 * k / distance * 0.1)
                    << k << ' ' << angle << ' ' << n;
            }
        }
    }
}

TEST(PointSound, LastsFromTheNearestToTheFarthestPointOfTheDisc) {
    const ShapeTable shapes(disc_modes(6));
    for (const double s : {0.0, 1e-9, 0.3, 1.0, 1.7, 20.0}) {
        for (const double z : {0.0, 1e-3, 2.0, 200.0}) {
            const PointSound sound(shapes, s, z);
            EXPECT_DOUBLE_EQ(sound.first(), std::hypot(std::max(0.0, s - 1), z));
            EXPECT_DOUBLE_EQ(sound.last(), std::hypot(s + 1, z));
            EXPECT_LT(sound(sound.last()).abs().maxCoeff(), 1e-6) << s << ' ' << z;
        }
    }
}

}  // namespace
}  // namespace hertzline
