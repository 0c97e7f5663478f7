// Numbers with units, as people write them.

#include "core/scene/units.hpp"

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "core/scene/scene_key.hpp"

namespace hertzline {
namespace {

TEST(Units, ANumberWithItsUnitIsTheSameDoubleAsWithoutIt) {
    for (int i = 1; i < 1000; ++i) {
        const std::string digits = std::to_string(i) + ".7";
        EXPECT_EQ(number_in_unit(digits + "um", "m"), std::stod(digits + "e-6"));
        EXPECT_EQ(number_in_unit(digits + "e2 GPa", "Pa"), std::stod(digits + "e11"));
    }
}

TEST(Units, KnowPrefixesPowersAndFractions) {
    EXPECT_EQ(number_in_unit("3 m", "m"), 3);
    EXPECT_EQ(number_in_unit("+3m", "m"), 3);
    EXPECT_EQ(number_in_unit("-.5 mm", "m"), -0.5e-3);
    EXPECT_EQ(number_in_unit("1.5E1\tnm", "m"), 15e-9);
    EXPECT_EQ(number_in_unit("3\u00b5m", "m"), 3e-6);  // the sign of micro
    EXPECT_EQ(number_in_unit("3\u03bcm", "m"), 3e-6);  // the Greek letter
    EXPECT_EQ(number_in_unit("2.7 g/cm^3", "kg/m^3"), 2700);
    EXPECT_EQ(number_in_unit("2.7g/cm3", "kg/m^3"), 2700);
    EXPECT_EQ(number_in_unit("2700 kg / m\u00b3", "kg/m^3"), 2700);
    EXPECT_EQ(number_in_unit("5 N/um", "N/m"), 5e6);
    EXPECT_EQ(number_in_unit("1.4 mm/us", "m/s"), 1400);
    EXPECT_EQ(number_in_unit("20us", "s"), 20e-6);
}

TEST(Units, ReadNothingElse) {
    for (const char* text :
         {"",        "3",       "m",    "3 mm mm", "3mN",  "3 mhz", "3k",   "3 m^2", "3 m/s",
          "inf m",   "nanm",    "0x10", "3,5 mm",  "--3m", "3 m^",  "3 /m", "3 m/",  "1e999999999999999999m",
          "1e308km", "3m\u00b9"}) {
        EXPECT_EQ(number_in_unit(text, "m"), std::nullopt) << text;
    }
    EXPECT_EQ(number_in_unit("3m", ""), std::nullopt);
    EXPECT_FALSE(has_unit("1 2"));
    EXPECT_FALSE(has_unit("1979-05-27"));
    EXPECT_TRUE(has_unit("3 parsec"));
}

TEST(Units, OfEveryKeyAreKnown) {
    std::vector<SceneKey> keys(scene_keys().begin(), scene_keys().end());
    for (const Material& material : {Material(Solid{}), Material(Fluid{})}) {
        for (SceneKey& key : material_keys("mine", material)) {
            keys.push_back(std::move(key));
        }
    }
    for (const SceneKey& key : keys) {
        const std::string unit(key.range.unit);
        EXPECT_TRUE(unit.empty() || number_in_unit("1 " + unit, unit) == 1) << key.name;
    }
}

}  // namespace
}  // namespace hertzline
