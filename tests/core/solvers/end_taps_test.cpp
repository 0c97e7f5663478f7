// The taps that follow from the motion at the chain's far end, against the equations of docs/model.md, for every integrator.

#include "core/solvers/end_taps.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/model/hertz.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

class EndTapsOf : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, EndTapsOf, every_integrator, integrator_name);

Scene with_end(EndKind kind) {
    Scene scene;
    scene.end.kind = kind;
    return scene;
}

TEST(EndTaps, OutputIsWhatTheOpenOrClosedContactTransmitsAndThePlatesVelocity) {
    Simulation simulation(with_step(Scene{}, Integrator::chin4a, 25e-9), {.taps = everything});
    Samples sample = simulation.make_samples(1);
    const Chain& chain = simulation.chain();
    const Eigen::Index n = chain.spheres();
    int opened = 0;
    for (int k = 0; k < 3000; ++k) {
        ASSERT_EQ(simulation.advance(sample, 1), Status::running);
        const ChainState& state = simulation.state();
        const bool closed = chain.static_overlap[n] + (state.x[n - 1] - state.x[n]) > 0;
        const double expected = (closed ? chain.end.transmission * state.v[n - 1] : 0) + state.v[n];
        ASSERT_NEAR(sample[Tap::v_out][0], expected, 1e-12) << k;
        opened += closed ? 0 : 1;
    }
    EXPECT_GT(opened, 100) << "the test must see both";
}

TEST_P(EndTapsOf, AWallAndAFreeEndGiveTheLastSpheresVelocity) {
    for (const EndKind kind : {EndKind::wall, EndKind::free}) {
        const Record record = recorded(with_step(with_end(kind), GetParam(), 50e-9), 2000);
        EXPECT_EQ(record.v_out, record.v_last);
        EXPECT_TRUE(record.v_plate.empty());
    }
}

TEST_P(EndTapsOf, TheLastSphereIsTheLastOfTheChain) {
    const Record record = recorded(with_step(Scene{}, GetParam(), 50e-9), 2000);
    for (std::size_t k = 0; k < record.v_last.size(); ++k) {
        ASSERT_EQ(record.v_last[k], record.chain_v[6 * k + 5]) << k;
    }
}

}  // namespace
}  // namespace hertzline::test
