#include "core/plate/laminate.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/end.hpp"
#include "core/plate/plate_modes.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {
namespace {

using testing::HasSubstr;

Layer layer(const char* material, double thickness_m, double loss_factor = 0.005) {
    return {solid_of(Scene{}, material), thickness_m, loss_factor};
}

Scene layered(std::vector<std::string> materials, std::vector<double> thicknesses_m) {
    Scene scene;
    scene.end.materials = std::move(materials);
    scene.end.thicknesses_m = std::move(thicknesses_m);
    return scene;
}

const Solid glue{3e9, 0.35, 1150};

TEST(Laminate, LayersOfOneMaterialAreOneLayer) {
    const PlateSection whole = plate_section(solid_of(Scene{}, "pyrex"), 0.7e-3, 0.01);
    for (const std::vector<double>& parts :
         {std::vector{0.7e-3}, std::vector{0.35e-3, 0.35e-3}, std::vector{0.2e-3, 0.1e-3, 0.4e-3}}) {
        std::vector<Layer> layers;
        for (const double part : parts) {
            layers.push_back(layer("pyrex", part, 0.01));
        }
        const Laminate found = laminate(layers);
        const auto near = [](double value, double expected) {
            EXPECT_NEAR(value, expected, 2e-15 * expected);
        };
        near(found.section.thickness_m, whole.thickness_m);
        near(found.section.bending_n_m, whole.bending_n_m);
        near(found.section.mass_kg_per_m2, whole.mass_kg_per_m2);
        near(found.section.shear_n_per_m, whole.shear_n_per_m);
        near(found.section.rotary_kg, whole.rotary_kg);
        near(found.section.loss_factor, whole.loss_factor);
        near(found.neutral_plane_m, 0.35e-3);
        near(found.shear_ratio, 1);
    }
}

// Reference: an independent program, to all digits.
TEST(Laminate, SectionsAreThoseOfAnIndependentProgram) {
    const Laminate two = laminate(std::vector{layer("aluminium", 0.2e-3), layer("acrylic", 0.5e-3)});
    EXPECT_NEAR(two.section.bending_n_m, 0.241100948434, 1e-12);
    EXPECT_NEAR(two.section.mass_kg_per_m2, 1.135, 1e-12);
    EXPECT_NEAR(two.section.loss_factor, 0.005, 1e-15);
    EXPECT_NEAR(plate_stiffness(layered({"aluminium", "acrylic"}, {0.2e-3, 0.5e-3})), 484762, 0.5);
    const Laminate glued = laminate(
        std::vector{layer("vitreous_carbon", 0.3e-3), Layer{glue, 0.02e-3, 0.005}, layer("acrylic", 0.2e-3)});
    EXPECT_NEAR(glued.section.bending_n_m, 0.123366972, 5e-10);
    EXPECT_NEAR(glued.section.mass_kg_per_m2, 0.687, 1e-15);
}

// Reference: an independent program, to all digits.
TEST(Laminate, ALayerLosesByItsShareOfTheBending) {
    Scene scene = layered({"aluminium", "acrylic"}, {0.2e-3, 0.5e-3});
    scene.end.loss_factors = {0.001, 0.02};
    const Laminate two = laminate(layers_of(scene));
    EXPECT_NEAR(two.section.loss_factor, 0.014871156412892888, 1e-15);
    EXPECT_NEAR(two.neutral_plane_m, 0.12948235605509181e-3, 1e-17);  // from the sphere's side
}

TEST(Laminate, ModesAreThoseOfAnIndependentProgram) {
    Scene scene = layered({"aluminium", "acrylic"}, {0.2e-3, 0.5e-3});
    scene.end.model = PlateModel::modal;
    const auto expect = [](Scene of, PlateTheory theory, const std::vector<double>& kilohertz) {
        of.end.theory = theory;
        const auto modes = dry_modes(plate_parameters(of));
        for (std::size_t n = 0; n < kilohertz.size(); ++n) {
            EXPECT_NEAR(modes[n].dry_hz / 1e3, kilohertz[n], 0.06) << n;
        }
    };
    expect(scene, PlateTheory::thin, {30.0, 116.7, 261.4, 464.1});
    expect(scene, PlateTheory::thick, {27.6, 92.4, 176.2, 269.0});
    scene.materials["glue"] = glue;
    scene.end.materials = {"vitreous_carbon", "glue", "acrylic"};
    scene.end.thicknesses_m = {0.3e-3, 0.02e-3, 0.2e-3};
    expect(scene, PlateTheory::thin, {27.6, 107.3, 240.4, 426.7});
    expect(scene, PlateTheory::thick, {27.1, 101.1, 213.6, 354.5});
}

TEST(Laminate, TurnedOverItBendsTheSame) {
    std::vector<Layer> layers{layer("steel", 0.1e-3, 0.001), layer("epoxy", 0.05e-3, 0.05),
                              layer("pyrex", 0.3e-3, 0.01)};
    const Laminate one = laminate(layers);
    std::ranges::reverse(layers);
    const Laminate other = laminate(layers);
    EXPECT_NEAR(other.section.bending_n_m / one.section.bending_n_m, 1, 1e-14);
    EXPECT_NEAR(other.section.shear_n_per_m / one.section.shear_n_per_m, 1, 1e-13);
    EXPECT_NEAR(other.section.rotary_kg / one.section.rotary_kg, 1, 1e-14);
    EXPECT_NEAR(other.section.loss_factor / one.section.loss_factor, 1, 1e-14);
    EXPECT_NEAR(other.neutral_plane_m + one.neutral_plane_m, one.section.thickness_m, 1e-18);
}

TEST(Laminate, ASoftLayerBetweenStiffOnesIsRefusedWithTheFigure) {
    Scene scene = layered({"aluminium", "silicone_rubber", "aluminium"}, {0.2e-3, 0.1e-3, 0.2e-3});
    for (const PlateModel model : {PlateModel::lumped, PlateModel::modal}) {
        scene.end.model = model;
        const auto faults = plate_faults(scene);
        ASSERT_EQ(faults.size(), 1U);
        EXPECT_EQ(faults[0].key, "end.materials");
        EXPECT_THAT(faults[0].message(), HasSubstr("layers whose shear stiffness is 0.0"));
    }
    scene.end.materials = {"aluminium", "epoxy", "aluminium"};
    EXPECT_TRUE(plate_faults(scene).empty());
}

TEST(Layers, TheFirstTouchesTheSphereAndSoundPassesAllOfThem) {
    const Scene scene = layered({"aluminium", "acrylic"}, {0.2e-3, 0.5e-3});
    const auto z = [&](const char* material) { return acoustic_impedance(*find_material(scene, material)); };
    const double product = transmission(z("aluminium"), z("aluminium")) *
                           transmission(z("aluminium"), z("acrylic")) *
                           transmission(z("acrylic"), z("water"));
    EXPECT_NEAR(output_transmission(scene), std::sqrt(product), 1e-15);
    Scene aluminium;
    aluminium.end.material = "aluminium";
    EXPECT_EQ(end_model(scene).contact_stiffness, end_model(aluminium).contact_stiffness);
    Scene one = layered({"aluminium"}, {aluminium.end.thickness_m});
    EXPECT_EQ(end_model(one).body.spring, end_model(aluminium).body.spring);
    EXPECT_EQ(end_model(one).body.inv_mass, end_model(aluminium).body.inv_mass);
    EXPECT_EQ(end_model(one).transmission, end_model(aluminium).transmission);
}

}  // namespace
}  // namespace hertzline
