#include "recordings/columns.hpp"

#include <string>

#include <gtest/gtest.h>

namespace hertzline::recordings {
namespace {

std::string quantity_and_unit(const std::string& name) {
    const Column column = column_named(name);
    return column.quantity + " in " + column.unit;
}

TEST(Columns, EndInTheirUnit) {
    EXPECT_EQ(quantity_and_unit("v_out_m_per_s"), "v_out in m/s");
    EXPECT_EQ(quantity_and_unit("v_out_mm_per_s"), "v_out in mm/s");
    EXPECT_EQ(quantity_and_unit("v_um_per_ms"), "v in um/ms");
    EXPECT_EQ(quantity_and_unit("v_mm_s"), "v in mm/s");
    EXPECT_EQ(quantity_and_unit("vibrometer_x_nm"), "vibrometer_x in nm");
    EXPECT_EQ(quantity_and_unit("tip_kPa"), "tip in kPa");
    for (const std::string name :
         {"a", "channel_1", "per_s", "_m", "_per_s", "v_per_", "x_m_", "x_1", "x_", "delay_s", "_s", ""}) {
        EXPECT_EQ(quantity_and_unit(name), name + " in ");
    }
}

TEST(Columns, MayHaveTheirUnitInBrackets) {
    const auto column = [](const std::string& title) {
        const Column found = column_titled(title);
        return found.name + " in " + found.unit;
    };
    EXPECT_EQ(column("Channel 1 (mm/s)"), "Channel 1 in mm/s");
    EXPECT_EQ(column(" x [um] "), "x in um");
    EXPECT_EQ(column("x_um"), "x_um in um");
    for (const std::string title : {"(V)", "x (", "x ) y", "f(x) of y", ")", ""}) {
        EXPECT_EQ(column(title), title + " in ");
    }
}

}  // namespace
}  // namespace hertzline::recordings
