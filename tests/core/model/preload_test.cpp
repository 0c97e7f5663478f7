// The static force that holds the chain together, at each kind of end.

#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

class Preload : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, Preload, every_integrator, integrator_name);

TEST_P(Preload, AsPrintedStartsThePlateWithAKick) {
    Scene scene = with_step(Scene{}, GetParam(), 1e-9);
    scene.end.preload = PlatePreload::as_printed;
    scene.output.sample_rate_hz = 1e9;
    const Record record = recorded(scene, 11);
    const double quarter_mass = 1420 * std::numbers::pi * 25e-6 * 0.5e-3 / 4;
    EXPECT_NEAR(record.v_plate[10] / (0.1 / quarter_mass * 10e-9), 1, 5e-3);
    EXPECT_EQ(record.v_plate[0], 0);
}

TEST_P(Preload, AFreeEndFeelsThePreloadAsAConstantForce) {
    // without a horn's motion nothing happens; thrown off the horn, the chain is pushed back by F0
    Scene scene;
    scene.end.kind = EndKind::free;
    scene.chain.spheres = 1;
    scene.chain.damping_kg_per_s = 0;
    scene.drive.cycles = 1;
    const Record record = recorded(with_step(scene, GetParam(), 10e-9), 400);
    const Chain chain(scene);
    int flights = 0;
    for (std::size_t i = 1; i + 1 < 400; ++i) {
        const double overlap_if_horn_rests = chain.static_overlap[0] - record.chain_x[i];
        if (overlap_if_horn_rests < -4e-6) {  // beyond the horn's reach
            const double force = (record.v_last[i + 1] - record.v_last[i - 1]) / 2e-7 / chain.inv_mass[0];
            EXPECT_NEAR(force, -0.1, 1e-6);
            ++flights;
        }
    }
    EXPECT_GT(flights, 10);
}

}  // namespace
}  // namespace hertzline::test
