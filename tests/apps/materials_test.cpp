#include "hertzline/materials.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/program.hpp"

namespace hertzline::test {

namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

TEST(Materials, AllAreListedWithTheirNumbersAndSources) {
    const auto list = hertzline({"materials", "--json"}).json();
    const auto table = built_in_materials();
    ASSERT_EQ(list.size(), table.size());
    const std::string text = hertzline({"materials"}).out;
    for (std::size_t i = 0; i < table.size(); ++i) {
        EXPECT_EQ(list[i]["name"], std::string(table[i].name));
        EXPECT_EQ(list[i]["impedance_pa_s_per_m"], acoustic_impedance(table[i].material));
        EXPECT_THAT(text, HasSubstr(std::string(table[i].name) + " "));
        EXPECT_THAT(text, HasSubstr(std::string(table[i].source) + "\n"));
    }
    EXPECT_TRUE(list.back()["youngs_modulus_pa"].is_null());  // a fluid
    // sqrt(1 / (rho / M)): 998 kg/m^3 and 1482 m/s are 1.479 MRayl
    EXPECT_THAT(text, ContainsRegex("water +- +- +998 +1482 +1.479 "));
}

TEST(Materials, AreWhatTheReadmeCounts) {
    const std::string readme = contents(std::filesystem::path(HERTZLINE_SOURCE_DIR) / "scenes/README.md");
    std::size_t solids = 0;
    for (const BuiltInMaterial& row : built_in_materials()) {
        solids += std::holds_alternative<Solid>(row.material) ? 1 : 0;
    }
    const std::size_t fluids = built_in_materials().size() - solids;
    EXPECT_THAT(readme, HasSubstr("lists the " + std::to_string(solids) + " solids and " +
                                  std::to_string(fluids) + " fluids"));
}

}  // namespace

}  // namespace hertzline::test
