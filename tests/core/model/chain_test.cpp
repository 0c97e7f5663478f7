#include "core/model/chain.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/end.hpp"
#include "core/model/sphere_row.hpp"
#include "core/model/validity.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Scene mixed_scene() {
    Scene scene;
    scene.chain.materials = {"steel", "aluminium", "steel"};
    scene.chain.diameters_m = {2e-3, 1e-3};
    scene.chain.spheres = 7;
    scene.chain.taper = 0.1;
    return scene;
}

TEST(SphereRow, RepeatsItsListsAndTapers) {
    const Scene scene = mixed_scene();
    const SphereRow row(scene);
    EXPECT_EQ(row.material(3), "steel");
    EXPECT_EQ(row.material(4), "aluminium");
    EXPECT_NEAR(row[5].radius_m, 0.5e-3 * std::pow(0.9, 5), 1e-18);
    EXPECT_NEAR(row[4].mass_kg, 2700 * 4.0 / 3 * std::numbers::pi * std::pow(1e-3 * std::pow(0.9, 4), 3),
                1e-15);
    EXPECT_EQ(row.period(), 7);
    Scene straight = scene;
    straight.chain.taper = 0;
    EXPECT_EQ(SphereRow(straight).period(), 6);
    EXPECT_EQ(last_material(scene), "steel");
    EXPECT_THAT(sphere_materials(scene), ElementsAre("steel", "aluminium"));
}

TEST(Chain, OfDifferentSpheresHasTheTextbooksContactsAndReducedMasses) {
    Scene scene = mixed_scene();
    scene.chain.damping_law = DampingLaw::tsuji;
    scene.chain.damping_alpha = 0.3;
    const Chain chain(scene);
    // Johnson 1985, equation 4.23: k = 4/3 sqrt(R) E*, 1/R = 1/R_a + 1/R_b, 1/E* = (1 - nu^2)/E of both
    const double a = 1e-3;
    const double b = 0.5e-3 * 0.9;
    const double modulus = 1 / ((1 - 0.3 * 0.3) / 201e9 + (1 - 0.33 * 0.33) / 69e9);
    const double stiffness = 4.0 / 3 * std::sqrt(1 / (1 / a + 1 / b)) * modulus;
    EXPECT_NEAR(chain.stiffness[1] / stiffness, 1, 1e-14);
    const double mass = 1 / (chain.inv_mass[0] + chain.inv_mass[1]);
    EXPECT_NEAR(chain.damping[1] / (0.3 * std::sqrt(mass * stiffness)), 1, 1e-14);
    EXPECT_NEAR(curvature_radius(chain, 1), 1 / (1 / a + 1 / b), 1e-18);
    EXPECT_NEAR(chain.end.transmission, output_transmission(scene), 0);
    scene.chain.material = "steel";  // of the last sphere
    scene.chain.materials.clear();
    EXPECT_EQ(Chain(scene).end.transmission, chain.end.transmission);
}

TEST(Chain, OfEqualEntriesIsTheUniformOneBitForBit) {
    const Chain uniform{Scene{}};
    Scene scene;
    scene.chain.materials = {"aluminium", "aluminium"};
    scene.chain.diameters_m = {1e-3, 1e-3, 1e-3};
    const Chain chain(scene);
    EXPECT_TRUE((chain.stiffness == uniform.stiffness).all());
    EXPECT_TRUE((chain.static_overlap == uniform.static_overlap).all());
    EXPECT_TRUE((chain.damping == uniform.damping).all());
    EXPECT_TRUE((chain.inv_mass == uniform.inv_mass).all());
}

TEST(Chain, CarriesItsWeightFromContactToContact) {
    Scene scene;
    scene.chain.gravity_m_per_s2 = 9.81;
    scene.chain.preload_n = 1e-5;
    const Chain chain(scene);
    const double weight = 9.81 / chain.inv_mass[0];
    for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
        EXPECT_NEAR(chain.static_force[c] / (1e-5 + static_cast<double>(c) * weight), 1, 1e-12) << c;
    }
    EXPECT_NEAR(chain.end_force_n / (1e-5 + 6 * weight), 1, 1e-12);
    EXPECT_THAT(chain_faults(scene), IsEmpty());
    scene.chain.gravity_m_per_s2 = -9.81;
    const auto faults = chain_faults(scene);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_THAT(faults.front().message(),
                AllOf(HasSubstr("chain.gravity_m_per_s2: found -9.81"), HasSubstr("the preload of 1e-05 N")));
}

TEST(Chain, ThatTapersBeyondAllBoundsIsRefused) {
    Scene scene;
    scene.chain.taper = 0.5;
    scene.chain.spheres = 21;
    EXPECT_THAT(chain_faults(scene), ElementsAre(testing::Field(&Fault::key, "chain.taper")));
    scene.chain.spheres = 20;
    EXPECT_THAT(chain_faults(scene), IsEmpty());
}

TEST(Chain, WithoutAHornOrWithStrikersHasFaultsOfItsOwn) {
    Scene scene;
    scene.drive.kind = DriveKind::none;
    scene.drive.repetition_hz = 1000;
    scene.chain.impact_spheres = 7;
    const std::vector<Fault> faults = validate(scene);
    ASSERT_EQ(faults.size(), 2U);
    EXPECT_EQ(faults[0].message(),
              "drive.repetition_hz: found 1000 with drive.kind = \"none\", allowed: 0: there is no horn to "
              "repeat its bursts");
    EXPECT_EQ(faults[1].message(), "chain.impact_spheres: found 7, allowed: at most chain.spheres = 6");
}

TEST(Chain, StartsWithItsStrikersAndReturnsToThemOnReset) {
    Scene scene;
    scene.chain.impact_velocity_m_per_s = 0.3;
    scene.chain.impact_spheres = 2;
    const Chain chain(scene);
    ChainState state(chain);
    EXPECT_TRUE((state.v.head(2) == 0.3).all());
    EXPECT_TRUE((state.v.tail(5) == 0).all());
    state.reset_motion(chain);
    EXPECT_TRUE((state.v == 0).all());
    EXPECT_TRUE(chain.balanced());
    scene.end.preload = PlatePreload::as_printed;
    EXPECT_FALSE(Chain(scene).balanced());
}

}  // namespace
}  // namespace hertzline
