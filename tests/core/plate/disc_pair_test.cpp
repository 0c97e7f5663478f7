// The load that discs in a baffle are to each other, against an independent program and other ways to the same numbers.

#include "core/plate/disc_pair.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <sstream>

#include <gtest/gtest.h>

#include "core/plate/quadrature.hpp"

namespace hertzline::test {
namespace {

TEST(DiscPair, ImpedancesAreThoseOfAnIndependentProgram) {
    std::ifstream file(HERTZLINE_SOURCE_DIR "/tests/reference/array/coupling_12mm.csv");
    std::string line;
    std::getline(file, line);
    constexpr double a = 5e-3;
    constexpr double c = 1482;
    constexpr double unit = 998 * c * std::numbers::pi * a * a;
    const ModeCorrelation correlation(disc_modes(4));
    std::map<double, std::unique_ptr<PairMemory>> memories;
    double largest = 0;
    double worst = 0;
    int rows = 0;
    while (std::getline(file, line)) {
        std::ranges::replace(line, ',', ' ');
        std::istringstream row(line);
        Eigen::Index m = 0;
        Eigen::Index n = 0;
        double f = 0;
        double d = 0;
        double re = 0;
        double im = 0;
        row >> m >> n >> f >> d >> re >> im;
        largest = std::max(largest, std::hypot(re, im));
        if (d == 0) {
            continue;
        }
        std::unique_ptr<PairMemory>& memory = memories[d];
        memory = memory ? std::move(memory) : std::make_unique<PairMemory>(correlation, d / a);
        const Eigen::MatrixXcd impedance = unit * memory->impedance(2 * std::numbers::pi * f * a / c);
        worst = std::max(worst, std::abs(impedance(m - 1, n - 1) - std::complex<double>(re, im)));
        ++rows;
    }
    EXPECT_EQ(rows, 140);
    EXPECT_LT(worst, 1e-8 * largest);
}

/// Far apart, discs are heard as from their centres: Z goes to i k a/(2 pi d/a) pi times the modes' means, with the wave of the way.
TEST(DiscPair, FarApartItIsTheSoundOfTwoPoints) {
    const std::vector<DiscMode> modes = disc_modes(3);
    const PairMemory memory(ModeCorrelation(modes), 400);
    constexpr double ka = 0.02;
    const Eigen::MatrixXcd impedance = memory.impedance(ka);
    for (Eigen::Index m = 0; m < 3; ++m) {
        for (Eigen::Index n = 0; n < 3; ++n) {
            const std::complex<double> points =
                std::complex<double>(0, ka) / (2 * 400.0) * modes[static_cast<std::size_t>(m)].mean() *
                modes[static_cast<std::size_t>(n)].mean() * std::polar(1.0, -ka * 400);
            EXPECT_LT(std::abs(impedance(m, n) - points), 1e-3 * std::abs(points)) << m << n;
        }
    }
}

TEST(DiscPair, SoundTakesTheWayBetweenTheRims) {
    const PairMemory memory(ModeCorrelation(disc_modes(2)), 2.5);
    EXPECT_EQ(memory.first(), 0.5);
    EXPECT_EQ(memory.last(), 4.5);
    EXPECT_EQ(memory(0.49).norm(), 0);
    EXPECT_EQ(memory(4.51).norm(), 0);
    EXPECT_LT(memory(0.51).norm(), 1e-3 * memory(1.5).norm());
    EXPECT_GT(memory(1.5).norm(), 0);
}

}  // namespace
}  // namespace hertzline::test
