// Ahead of a wave that comes to spheres without preload they move less and less, by tens of powers of ten from one to the
// next. Contacts close there almost without moving, and the motion bends within any piece.

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "hertzline/simulation.hpp"
#include "tests/support/design_scene.hpp"

namespace hertzline::test {
namespace {

std::vector<double> last_velocities(Scene scene, double step_s) {
    scene.numerics = Numerics{};
    scene.numerics.integrator = Integrator::taylor12;
    scene.numerics.step_s = step_s;
    Simulation simulation(scene, {.taps = Tap::v_last});
    Samples block = simulation.make_samples(2000);
    EXPECT_EQ(simulation.advance(block, block.capacity()), Status::running);
    return {block[Tap::v_last].begin(), block[Tap::v_last].end()};
}

TEST(WaveFront, KicksNoSphereAheadOfIt) {
    const Scene scene = design_scene(4711, 2).scene;  // 140 spheres
    ASSERT_EQ(scene.chain.spheres, 140);
    ASSERT_EQ(scene.chain.preload_n, 0);
    const std::vector<double> truth = last_velocities(scene, 5e-8);
    for (const double step_s : {1.5e-7, 1e-7, 0.9e-7, 0.7e-7}) {
        const std::vector<double> found = last_velocities(scene, step_s);
        double wrong = 0;
        double norm = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            wrong += std::pow(found[i] - truth[i], 2);
            norm += std::pow(truth[i], 2);
        }
        EXPECT_LT(std::sqrt(wrong / norm), 1e-8) << step_s;
    }
}

}  // namespace
}  // namespace hertzline::test
