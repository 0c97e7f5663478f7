// The spot of a beam, from peak pressures along a line.

#include "measures/beam.hpp"

#include <gtest/gtest.h>

namespace hertzline::test {
namespace {

/// A run with these peaks at points that are a millimetre apart.
hertzline::Run with_peaks(const std::vector<double>& peaks_pa) {
    hertzline::Run run;
    run.peaks_p_points = peaks_pa;
    for (std::size_t i = 0; i < peaks_pa.size(); ++i) {
        run.resolved.scene.output.points_m.push_back({1e-3 * static_cast<double>(i), 0, 0.04});
    }
    return run;
}

TEST(Beam, TheSpotEndsWhereThePeaksHaveFallenBySixDecibels) {
    // from 100 to 20 in a millimetre: 50.119 after 0.623516 mm, on both sides
    EXPECT_NEAR(measures::spot_width_m(with_peaks({0, 20, 100, 20, 0})).value(), 2 * 0.623516e-3, 1e-8);
    EXPECT_NEAR(measures::spot_width_m(with_peaks({10, 80, 100, 80, 10})).value(), 2 * 1.426875e-3, 1e-8);
}

TEST(Beam, ASpotThatTheLineCutsHasNoWidth) {
    EXPECT_FALSE(measures::spot_width_m(with_peaks({100, 20, 0})));
    EXPECT_FALSE(measures::spot_width_m(with_peaks({0, 20, 100, 80})));
    EXPECT_FALSE(measures::spot_width_m(with_peaks({100})));
}

TEST(Beam, ASideLobeLiesBeyondAMinimum) {
    EXPECT_NEAR(measures::side_lobe_db(with_peaks({5, 10, 2, 100, 1, 20, 3})).value(), -13.979, 1e-3);
    EXPECT_FALSE(measures::side_lobe_db(with_peaks({10, 50, 100, 50, 10})));
    EXPECT_FALSE(measures::side_lobe_db(with_peaks({30, 33, 33, 30})));
}

TEST(Beam, PointsThatAreNoLineInItsOrderHaveNoSpot) {
    hertzline::Run run = with_peaks({5, 10, 2, 100, 1, 20, 3});
    auto& points = run.resolved.scene.output.points_m;
    std::swap(points[0], points[3]);
    EXPECT_FALSE(measures::spot_width_m(run));
    EXPECT_FALSE(measures::side_lobe_db(run));
    std::swap(points[0], points[3]);
    EXPECT_TRUE(measures::side_lobe_db(run));
    points[2][1] = 1e-3;
    EXPECT_FALSE(measures::side_lobe_db(run));
}

}  // namespace
}  // namespace hertzline::test
