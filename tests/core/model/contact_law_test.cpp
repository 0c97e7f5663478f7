// The constants that a chain is derived from: contact law, plate, transmission, masses.

#include "core/model/contact_law.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "core/model/chain.hpp"
#include "core/model/end.hpp"

namespace hertzline::test {
namespace {

TEST(Contact, TheStaticOverlapCarriesThePreload) {
    for (const EndKind end : {EndKind::plate, EndKind::wall}) {
        Scene scene;
        scene.end.kind = end;
        const Chain chain(scene);
        for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
            EXPECT_NEAR(elastic_force(chain.stiffness[c], chain.static_overlap[c]), 0.1, 1e-16);
        }
    }
}

TEST(Contact, ForceIsTheSlopeOfEnergyAndTangentTheSlopeOfForce) {
    constexpr double k = 1e9;
    for (const double overlap : {1e-8, 3e-7, 5e-6}) {
        const double d = overlap * 1e-4;
        const double force = (elastic_energy(k, overlap + d) - elastic_energy(k, overlap - d)) / (2 * d);
        const double tangent = (elastic_force(k, overlap + d) - elastic_force(k, overlap - d)) / (2 * d);
        EXPECT_NEAR(force / elastic_force(k, overlap), 1, 1e-7);
        EXPECT_NEAR(tangent / tangent_stiffness(k, overlap), 1, 1e-7);
    }
    EXPECT_EQ(elastic_force(k, -1e-9), 0);
    EXPECT_EQ(tangent_stiffness(k, -1e-9), 0);
    EXPECT_EQ(elastic_energy(k, -1e-9), 0);
}

TEST(Coupling, PlateStiffnessesAreThoseOfTheory) {
    const std::vector<std::pair<const char*, double>> table{{"silicone_rubber", 2.76e3},
                                                            {"acrylic", 5.97e4},
                                                            {"vitreous_carbon", 7.50e5},
                                                            {"pyrex", 1.46e6},
                                                            {"aluminium", 1.62e6}};
    for (const auto& [name, stiffness] : table) {
        Scene disc;
        disc.end.material = name;
        EXPECT_NEAR(plate_stiffness(disc) / stiffness, 1, 0.005) << name;
    }
}

TEST(Coupling, TransmissionsAreThoseOfTheImpedances) {
    const std::vector<std::pair<const char*, double>> table{{"aluminium", 0.5480},
                                                            {"pyrex", 0.6030},
                                                            {"vitreous_carbon", 0.6902},
                                                            {"acrylic", 0.6290},
                                                            {"silicone_rubber", 0.5305}};
    for (const auto& [name, factor] : table) {
        Scene scene;
        scene.end.material = name;
        EXPECT_NEAR(output_transmission(scene), factor, 5e-5) << name;
        EXPECT_EQ(Chain(scene).end.transmission, output_transmission(scene));
    }
}

TEST(Chain, MassesAreThoseOfSpheresAndAQuarterOfTheDisc) {
    const Chain chain{Scene{}};
    EXPECT_NEAR(1 / chain.inv_mass[0], 1.4137e-6, 1e-10);
    EXPECT_NEAR(1 / chain.inv_mass[6], 1420 * std::numbers::pi * 25e-6 * 0.5e-3 / 4, 1e-12);
}

}  // namespace
}  // namespace hertzline::test
