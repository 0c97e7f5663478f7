#include "core/model/strength.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hertzline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Returns a scene with a wall of a material with these strengths. Spheres and horn have no known limit.
Scene scene_with(const std::optional<double>& yield_pa, const std::optional<double>& flexural_pa) {
    Scene scene;
    scene.end.kind = EndKind::wall;
    scene.end.material = "mine";
    scene.chain.material = "copper";
    scene.drive.material = "copper";
    scene.materials["mine"] = Solid{69e9, 0.33, 2700, yield_pa, flexural_pa};
    return scene;
}

std::optional<std::string> warning_at_rest(const Scene& scene) {
    const Chain chain(scene);
    return strength_warning(judge_contacts(scene, chain, chain.static_overlap));
}

double pressure_at_rest(const Scene& scene) {
    // Johnson 1985, equations 4.22 and 4.24: p0 = (6 F E*^2 / (pi^3 R^2))^(1/3)
    const Solid copper{129.8e9, 0.343, 8933};
    const auto& wall = std::get<Solid>(scene.materials.at("mine"));
    const double modulus = 1 / (1 / plane_strain_modulus(copper) + 1 / plane_strain_modulus(wall));
    const double radius = scene.chain.diameter_m / 2;
    return std::cbrt(6 * scene.chain.preload_n * modulus * modulus / std::pow(std::numbers::pi, 3) /
                     (radius * radius));
}

TEST(Strength, AMetalYieldsAt1p6OfItsYieldStrength) {
    const double pressure = pressure_at_rest(scene_with({}, {}));
    const auto beyond = warning_at_rest(scene_with(0.99 * pressure / 1.6, {}));
    ASSERT_TRUE(beyond);
    EXPECT_THAT(*beyond, AllOf(HasSubstr("sphere - end"), HasSubstr("mine yields from"),
                               Not(HasSubstr("horn")), Not(HasSubstr("sphere - sphere"))));
    EXPECT_FALSE(warning_at_rest(scene_with(1.01 * pressure / 1.6, {})));
}

TEST(Strength, ABrittleMaterialCracksByTheTensionAtTheEdge) {
    const double tension = (1 - 2 * 0.33) / 3 * pressure_at_rest(scene_with({}, {}));
    const auto beyond = warning_at_rest(scene_with({}, 0.99 * tension));
    ASSERT_TRUE(beyond);
    EXPECT_THAT(*beyond, HasSubstr("mine may crack from"));
    EXPECT_FALSE(warning_at_rest(scene_with({}, 1.01 * tension)));
}

TEST(Strength, TheLowerLimitCounts) {
    const Solid solid{69e9, 0.33, 2700, 100e6, 1e6};
    const auto limit = pressure_limit(solid, "mine");
    ASSERT_TRUE(limit);
    EXPECT_EQ(limit->failure, Failure::cracks);
    EXPECT_NEAR(limit->pressure_pa, 3e6 / 0.34, 1);
    EXPECT_EQ(pressure_limit(Solid{69e9, 0.33, 2700, 1e6, 100e6}, "mine")->pressure_pa, 1.6e6);
    EXPECT_FALSE(pressure_limit(Solid{69e9, 0.33, 2700}, "mine"));
}

TEST(Strength, EachKindOfContactIsNamedWithBothItsPressures) {
    Scene scene;  // aluminium spheres: 1.6 * 276 MPa
    const Chain chain(scene);
    const ContactLoad load = contact_load(chain, chain.static_overlap);
    EXPECT_NEAR(load.pressures_pa[1], 0.77e9, 0.01e9);
    EXPECT_EQ(*std::max_element(load.pressures_pa.begin(), load.pressures_pa.end()), load.pressure_pa);
    Eigen::ArrayXd overlaps = chain.static_overlap;
    overlaps[2] *= std::pow(2.3e9 / load.pressures_pa[1], 2);
    const JudgedContacts judged = judge_contacts(scene, chain, overlaps);
    const auto beyond = strength_warning(judged);
    ASSERT_TRUE(beyond);
    EXPECT_THAT(*beyond, AllOf(HasSubstr("horn - sphere "), HasSubstr(" MPa at rest (aluminium yields"),
                               HasSubstr("sphere - sphere 774 MPa at rest and 2300 MPa at most (aluminium "
                                         "yields from 442 MPa on, 1.6 times its yield strength)")));
    EXPECT_NEAR(*strength_ratio(judged), 2300 / (1.6 * 276), 1e-9);
}

TEST(Strength, ContactsOfMaterialsWhoseStrengthIsNotKnownAreNotJudgedAndThatIsSaid) {
    Scene scene = scene_with({}, {});
    scene.chain.preload_n = 1000;
    EXPECT_FALSE(warning_at_rest(scene));
    const Chain chain(scene);
    EXPECT_FALSE(strength_ratio(judge_contacts(scene, chain, chain.static_overlap)));
    EXPECT_EQ(unjudged_contacts(scene),
              "the strength of copper and mine is not known: the contacts horn - sphere, sphere - sphere, "
              "sphere - end are not judged by strength");
    scene.materials["mine"] = Solid{69e9, 0.33, 2700, 1e8, {}};
    EXPECT_EQ(
        unjudged_contacts(scene),
        "the strength of copper is not known: the contacts horn - sphere, sphere - sphere are not judged "
        "by strength, the contacts sphere - end by their other material alone");
    scene = Scene();
    scene.chain.material = "acrylic";
    EXPECT_EQ(
        unjudged_contacts(scene),
        "the strength of acrylic is not known: the contacts sphere - sphere are not judged by strength, "
        "the contacts horn - sphere, sphere - end by their other material alone");
    scene.chain.material = "steel";
    scene.end.material = "acrylic";
    EXPECT_EQ(unjudged_contacts(scene), std::nullopt);
    EXPECT_EQ(unjudged_contacts(Scene()), std::nullopt);
    scene = Scene();
    scene.chain.material = scene.drive.material = scene.end.material = "steel";
    EXPECT_EQ(unjudged_contacts(scene), std::nullopt);
    scene.chain.material = scene.drive.material = scene.end.material = "bearing_steel";
    EXPECT_EQ(unjudged_contacts(scene), std::nullopt);
}

TEST(Strength, OfAFreeEndThereIsNothingToBear) {
    Scene scene = scene_with(1.0, {});
    scene.end.kind = EndKind::free;
    EXPECT_FALSE(warning_at_rest(scene));
}

}  // namespace
}  // namespace hertzline
