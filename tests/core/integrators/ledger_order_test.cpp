// The residual of the energy ledger is below the requested accuracy, and falls with shorter steps by the method's order,
// down to rounding.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/integrators.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

constexpr double rounding = 1e-12;

const std::vector<std::string>& contact_scenes() {
    static const std::vector<std::string> files{"paper_vitreous_carbon", "paper_wall", "sonic_vacuum_10"};
    return files;
}

double residual(const Scene& scene) {
    Simulation simulation(scene);
    EXPECT_EQ(simulation.skip(5001), Status::running);
    return simulation.energy_residual();
}

/// Returns the residuals at steps that shrink by a factor.
std::vector<double> residuals(const std::string& file, Integrator integrator, double longest, double factor,
                              int count) {
    std::vector<double> all;
    for (int i = 0; i < count; ++i) {
        all.push_back(residual(with_step(reference_scene(file), integrator, longest / std::pow(factor, i))));
    }
    return all;
}

TEST(LedgerOrder, TheResidualStaysBelowTheAccuracyAskedFor) {
    for (const Integrator integrator : locating_integrators()) {
        const double tightest = integrator == Integrator::chin4a ? 1e-6 : 1e-9;
        for (const std::string& file : contact_scenes()) {
            for (double accuracy = 1e-3; accuracy > 0.5 * tightest; accuracy /= 10) {
                Scene scene = reference_scene(file);
                scene.numerics.integrator = integrator;
                scene.numerics.accuracy = accuracy;
                EXPECT_LE(residual(settled(scene)), accuracy) << word(integrator) << ' ' << file;
            }
        }
    }
}

TEST(LedgerOrder, Chin4aClosesItWithTheFourthOrderDownToRounding) {
    const auto fall = residuals("small_amplitude_wall", Integrator::chin4a, 200e-9, 2, 6);
    for (std::size_t i = 1; i < 5; ++i) {
        EXPECT_NEAR(std::log2(fall[i - 1] / fall[i]), 4, 0.3) << i;
    }
    EXPECT_LE(fall.back(), rounding);
}

TEST(LedgerOrder, Chin4aKeepsMoreThanTheSecondOrderThroughContacts) {
    for (const std::string& file : contact_scenes()) {
        const auto fall = residuals(file, Integrator::chin4a, 400e-9, 2, 8);
        const double order = std::log2(fall.front() / fall.back()) / 7;
        EXPECT_GE(order, 2.5) << file;
        EXPECT_LE(order, 4.2) << file;
        EXPECT_LE(fall.back(), 2e-10) << file;
    }
}

TEST(LedgerOrder, SeriesCloseItByTheLawOfTheirToleranceDownToRounding) {
    // the tolerance of a piece falls with the fifteenth power of the step, pieces shorten a little with it
    for (const Integrator integrator : series_integrators()) {
        for (const std::string& file : contact_scenes()) {
            const auto fall = residuals(file, integrator, 960e-9, 1.25, 7);
            ASSERT_GT(fall[1], 2 * rounding) << file;
            for (std::size_t i = 1; i < fall.size() && fall[i] > 2 * rounding; ++i) {
                const double order = std::log(fall[i - 1] / fall[i]) / std::log(1.25);
                EXPECT_GE(order, 12) << file << ' ' << i;
                EXPECT_LE(order, 16) << file << ' ' << i;
            }
            EXPECT_LE(fall.back(), rounding) << file;
        }
        EXPECT_LE(residuals("small_amplitude_wall", integrator, 700e-9, 2, 1).front(), rounding);
    }
}

}  // namespace
}  // namespace hertzline::test
