// Diameters and preloads that scatter.

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/model/chain.hpp"
#include "core/model/sphere_row.hpp"
#include "core/scene/elements.hpp"

namespace hertzline::test {
namespace {

/// Numbers of the same recipe, written in Python.
TEST(Tolerance, DrawsTheSameOnEveryMachine) {
    Scene scene;
    EXPECT_DOUBLE_EQ(drawn(scene, 0), 0.47539850538023387);
    EXPECT_DOUBLE_EQ(drawn(scene, -1), 0.053435991143655714);
    scene.chain.seed = 2;
    EXPECT_DOUBLE_EQ(drawn(scene, 0), 0.16024271880211693);
}

TEST(Tolerance, EachDiameterIsWithinItAndNoneIsLikeAnother) {
    Scene scene;
    scene.chain.spheres = 500;
    scene.chain.tolerance = 0.01;
    const SphereRow row(scene);
    std::set<double> radii;
    double mean = 0;
    for (Eigen::Index i = 0; i < row.size(); ++i) {
        const double part = 2 * row[i].radius_m / scene.chain.diameter_m - 1;
        EXPECT_LE(std::abs(part), 0.01);
        mean += part / 500;
        radii.insert(row[i].radius_m);
    }
    EXPECT_EQ(radii.size(), 500U);
    EXPECT_EQ(row.period(), 500);
    EXPECT_LT(std::abs(mean), 0.001) << "five standard errors are 0.0013";
}

TEST(Tolerance, NoneLeavesEveryChainAsItIs) {
    Scene scene;
    scene.chain.seed = 7;
    EXPECT_TRUE((Chain(scene).inv_mass == Chain(Scene{}).inv_mass).all());
    EXPECT_EQ(Chain(scene).preload_n, 0.1);
}

TEST(Tolerance, ThePreloadIsDrawnToo) {
    Scene scene;
    scene.chain.preload_tolerance = 0.2;
    const double preload = Chain(scene).preload_n;
    EXPECT_NE(preload, 0.1);
    EXPECT_NEAR(preload, 0.1, 0.02);
    EXPECT_GT(std::abs(preload - 0.1), 1e-4);
}

TEST(Tolerance, TheElementsOfAnArrayDrawTheirOwn) {
    Scene scene;
    scene.end.model = PlateModel::modal;
    scene.array.x_m = {0, 12e-3, 24e-3};
    scene.array.y_m = {0, 0, 0};
    scene.chain.tolerance = 0.01;
    EXPECT_NE(SphereRow(element_scene(scene, 0))[0].radius_m, SphereRow(element_scene(scene, 1))[0].radius_m);
    EXPECT_EQ(SphereRow(element_scene(scene, 0))[0].radius_m, SphereRow(element_scene(scene, 0))[0].radius_m);
    scene.chain.seed = 1'000'000'000;
    EXPECT_TRUE(validate(element_scene(scene, 1)).empty()) << "a seed beyond the largest";
}

}  // namespace
}  // namespace hertzline::test
