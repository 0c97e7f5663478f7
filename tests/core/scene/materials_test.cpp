#include "hertzline/materials.hpp"

#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene.hpp"

namespace hertzline {
namespace {

TEST(Materials, EachHasANameOfItsOwnAndASource) {
    std::set<std::string_view> names;
    for (const BuiltInMaterial& row : built_in_materials()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_FALSE(row.source.empty()) << row.name;
    }
}

TEST(Materials, EachCanBeUsedInAScene) {
    for (const BuiltInMaterial& row : built_in_materials()) {
        Scene scene;
        if (std::holds_alternative<Solid>(row.material)) {
            scene.drive.material = scene.chain.material = scene.end.material = row.name;
        } else {
            scene.medium.material = row.name;
        }
        EXPECT_THAT(validate(scene), testing::IsEmpty()) << row.name;
        // Own materials are held to the bounds of their keys: the built-in ones keep them, too.
        Scene own = scene;
        own.materials[std::string(row.name)] = row.material;
        EXPECT_THAT(validate(own), testing::IsEmpty()) << row.name;
    }
}

TEST(Materials, LongitudinalWavesAreAsFastAsMeasured) {
    // Ultrasonic measurements (D. R. Lide, CRC Handbook of Chemistry and Physics, speed of sound in various media) [m/s]
    const std::map<std::string_view, double> measured{{"copper", 4760},   {"tungsten", 5220},
                                                      {"titanium", 6070}, {"fused_silica", 5968},
                                                      {"lead", 2160},     {"magnesium", 5770}};
    std::size_t found = 0;
    for (const BuiltInMaterial& row : built_in_materials()) {
        if (const auto speed = measured.find(row.name); speed != measured.end()) {
            EXPECT_NEAR(acoustic_impedance(row.material) / std::get<Solid>(row.material).density_kg_per_m3,
                        speed->second, 0.02 * speed->second)
                << row.name;
            ++found;
        }
    }
    EXPECT_EQ(found, measured.size());
}

}  // namespace
}  // namespace hertzline
