// The order of the Taylor series: pieces of one length with any error, while all contacts stay closed.

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/integrators/kernels.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/scene/scene_words.hpp"

namespace hertzline::test {
namespace {

constexpr double duration_s = 24e-6;

/// Returns the velocities of a damped, driven chain of a few spheres after `pieces` pieces of equal length [m/s].
Eigen::ArrayXd velocities(DampingLaw law, Integrator integrator, int pieces) {
    Scene scene;
    scene.chain.damping_law = law;
    scene.chain.damping_time_s = 5e-7;
    scene.chain.damping_alpha = 0.3;
    scene.chain.spheres = 4;
    const Chain chain(scene);
    ChainState state(chain);
    state.v = 1e-3 * Eigen::ArrayXd::LinSpaced(chain.bodies(), -1, 1).cube();
    kernels::SimdChain simd_chain(chain, integrator, kernels::kernel_lanes());
    simd_chain.load(chain, state, chain.bodies());
    const double unit = duration_s / pieces;
    kernels::SeriesPiece piece(simd_chain.slots(), kernels::series_degree(integrator),
                               kernels::HornWaves({73e3, 75.92e3, 70.08e3}, unit), chain.damping_law);
    piece.unit_s = unit;
    piece.per_unit = 1 / unit;
    piece.tolerance = std::numeric_limits<double>::max();
    kernels::HornWaves& waves = piece.waves;
    waves.silent = false;
    waves.cosine = {2e-9, -1e-9, -1e-9, 0};
    for (std::size_t i = 0; i < 3; ++i) {
        waves.slope += waves.cosine[i] * waves.odd[i][0];
    }
    const kernels::SeriesKernels kernels =
        kernels::series_kernels(integrator, simd_chain.rows(), chain.damping_law);
    for (int i = 0; i < pieces; ++i) {
        kernels.piece(simd_chain, piece);
        EXPECT_EQ(piece.length, 1);
    }
    EXPECT_EQ(simd_chain.contact_events, 0);
    simd_chain.store(state);
    return state.v;
}

/// Returns the observed orders between successive numbers of pieces.
std::vector<double> orders(DampingLaw law, Integrator integrator, const std::vector<int>& pieces) {
    const Eigen::ArrayXd exact = velocities(law, Integrator::taylor12, 200);
    std::vector<double> result;
    double before = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const double error = (velocities(law, integrator, pieces[i]) - exact).matrix().norm();
        if (i > 0) {
            result.push_back(std::log(before / error) /
                             std::log(static_cast<double>(pieces[i]) / pieces[i - 1]));
        }
        before = error;
    }
    return result;
}

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Ge;
using ::testing::Le;

class SeriesOrder : public ::testing::TestWithParam<DampingLaw> {};
INSTANTIATE_TEST_SUITE_P(Laws, SeriesOrder, ::testing::ValuesIn(choices<DampingLaw>),
                         [](const auto& instance) { return std::string(word(instance.param)); });

TEST_P(SeriesOrder, Taylor8IsEighthOrderWithDampingPlateAndDrive) {
    EXPECT_THAT(orders(GetParam(), Integrator::taylor8, {64, 80, 104}), Each(AllOf(Ge(7.5), Le(8.6))));
}

TEST_P(SeriesOrder, Taylor12IsTwelfthOrderWithDampingPlateAndDrive) {
    EXPECT_THAT(orders(GetParam(), Integrator::taylor12, {24, 28, 32}), Each(AllOf(Ge(11.3), Le(13.1))));
}

}  // namespace
}  // namespace hertzline::test
