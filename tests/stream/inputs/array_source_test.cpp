// An array as the source of a stream: its chains are worked on by threads of their own.

#include <algorithm>

#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::stream::test {
namespace {

TEST(ArraySource, ThreadsGiveTheSameSamples) {
    Scene scene = read_scene("seven-chains");
    scene.numerics.integrator = Integrator::taylor8;
    scene.numerics.step_s = 0.7e-6;
    scene.numerics.poles = 28;
    constexpr TapSet taps = TapSet(Tap::v_last) | Tap::p_points;
    Simulation alone(scene, {.taps = taps});
    Simulation together(scene, {.taps = taps, .threads = 3});
    Samples expected = alone.make_samples(200);
    Samples samples = together.make_samples(200);
    for (int block = 0; block < 3; ++block) {
        ASSERT_EQ(alone.advance(expected, 200), Status::running);
        ASSERT_EQ(together.advance(samples, 200), Status::running);
        for (const Tap tap : taps) {
            EXPECT_TRUE(std::ranges::equal(samples[tap], expected[tap]));
        }
    }
}

}  // namespace
}  // namespace hertzline::stream::test
