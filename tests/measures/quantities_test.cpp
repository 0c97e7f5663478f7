#include "measures/quantities.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"

namespace hertzline {

using namespace measures;
namespace {

using testing::HasSubstr;

Scene shipped(const char* name) {
    Scene scene = parse_scene(find_shipped_scene(name)->text, name)->scene;
    scene.output.duration_s = 300e-6;
    return scene;
}

hertzline::Run run_of(const Scene& scene, const RunOptions& options = {}) {
    return run(resolve(scene), options);
}

/// Returns the row of docs/measures.md.
std::string row_in_document(const Quantity& quantity) {
    const bool of_tap = quantity.unit == "tap";
    const std::string name = of_tap ? "peak_v_out_m_per_s" : std::string(quantity.name);
    const std::string unit = of_tap                                  ? "m/s"
                             : !quantity.unit.empty()                ? std::string(quantity.unit)
                             : quantity.kind == measures::Kind::text ? ""
                                                                     : "1";
    return fmt::format("| `{}` |{}| {} |\n", name, unit.empty() ? " " : ' ' + unit + ' ',
                       quantity.definition);
}

TEST(Quantities, TheDocumentHasTheRowOfEach) {
    std::ifstream file(HERTZLINE_SOURCE_DIR "/docs/measures.md");
    const std::string document{std::istreambuf_iterator<char>(file), {}};
    for (const Quantity& quantity : quantities()) {
        EXPECT_THAT(document, HasSubstr(row_in_document(quantity)));
    }
}

/// Adds the columns of a flat object of a summary. @param before each name
void add_names(const Json& values, const std::string& before, std::set<std::string>& names) {
    for (const auto& [name, value] : values.items()) {
        if (value.is_object()) {
            add_names(value, name + '.', names);
        } else if (name.starts_with("harmonics_db") || name == "switching_db" ||
                   name == "peaks_p_points_pa") {
            for (std::size_t i = 1; i <= SpectrumAnalyser::max_harmonics; ++i) {
                names.insert(fmt::format("{}{}_{}", before, name, i));
            }
        } else if (!value.is_string()) {
            names.insert(before + name);
        }
    }
}

TEST(Quantities, EachNumberOfASummaryIsAColumnAndTheOtherWayRound) {
    const hertzline::Run result = run_of(shipped("wet-off-axis"));  // with points
    std::set<std::string> in_summary;
    add_names(summary_json(summary_of(result)), "", in_summary);
    for (const char* measured_anew : {"setup_s", "wall_s", "real_time_factor"}) {
        EXPECT_EQ(in_summary.erase(measured_anew), 1U) << measured_anew;
    }
    std::set<std::string> in_table;
    for (const NumberColumn& column : number_columns(measured_taps(result.scene(), {}), true)) {
        EXPECT_TRUE(in_table.insert(column.name).second) << column.name << " stands twice";
    }
    EXPECT_EQ(in_summary, in_table);
}

TEST(Quantities, ANumberIsTheSameInTheSummaryInAColumnAndByItsName) {
    const hertzline::Run result = run_of(shipped("paper-vitreous-carbon"), {.measured = Tap::v_plate});
    const Json summary = summary_json(summary_of(result));
    EXPECT_EQ(result["peak_v_out_m_per_s"], peak_of(result.taps.front().values));
    EXPECT_EQ(result["peak_v_out_m_per_s"], summary["peak_v_out_m_per_s"]);
    EXPECT_EQ(result["harmonics_db_3"], summary["harmonics_db"][2]);
    EXPECT_EQ(result["v_plate.thd_r"], summary["v_plate"]["thd_r"]);
    EXPECT_EQ(result["steps"], summary["steps"]);
    EXPECT_GT(result["v_plate.peak_v_plate_m_per_s"], 0);
}

TEST(Quantities, WhatARunDoesNotDetermineIsNoNumber) {
    const hertzline::Run result = run_of(shipped("paper-wall"));
    EXPECT_TRUE(std::isnan(result["radiated_j"]));            // no modal plate
    EXPECT_TRUE(std::isnan(result["switching_db_1"]));        // no plate
    EXPECT_THROW(result["p_axis.thd_r"], std::out_of_range);  // not measured
}

TEST(Quantities, AWrongNameIsRefusedWithTheOneThatWasMeant) {
    const hertzline::Run result = run_of(shipped("paper-wall"));
    try {
        static_cast<void>(result["peak_v_out_m_per_sec"]);
        FAIL();
    } catch (const std::out_of_range& error) {
        EXPECT_THAT(error.what(), HasSubstr("peak_v_out_m_per_s"));
    }
}

TEST(Quantities, UnitsAndCountsOfColumns) {
    const auto unit = [](const char* name) { return find_column(name)->unit; };
    EXPECT_EQ(unit("peak_v_out_m_per_s"), "m/s");
    EXPECT_EQ(unit("harmonics_db_10"), "dB");
    EXPECT_EQ(unit("bandwidth_6db_hz"), "Hz");
    EXPECT_EQ(unit("fractional_bandwidth_6db"), "");
    EXPECT_EQ(unit("p_axis.peak_p_axis_pa"), "Pa");
    EXPECT_EQ(unit("radiated_j"), "J");
    EXPECT_TRUE(find_column("steps")->whole);
    EXPECT_FALSE(find_column("step_s")->whole);
    EXPECT_FALSE(find_column("steps_"));
}

TEST(WholeRun, EndsWhenItIsStopped) {
    const std::atomic<bool> stop = true;
    const hertzline::Run result = run_of(shipped("paper-wall"), {.stop = &stop});
    EXPECT_TRUE(result.stopped);
    EXPECT_EQ(result.rows(), 0U);
}

TEST(WholeRun, EndsWhenItsBlocksAreRefused) {
    const hertzline::Run result =
        run_of(shipped("paper-wall"), {.take = [](const Samples&) { return false; }});
    EXPECT_TRUE(result.stopped);
}

TEST(WholeRun, GivesTheRecordedTapsBlockByBlock) {
    std::size_t rows = 0;
    std::size_t channels = 0;
    const hertzline::Run result =
        run_of(shipped("paper-wall"), {.recorded = Tap::x_chain, .take = [&](const Samples& block) {
                                           rows += block.count;
                                           channels = block[Tap::x_chain].size() / block.count;
                                           return true;
                                       }});
    EXPECT_EQ(rows, result.rows());
    EXPECT_EQ(channels, static_cast<std::size_t>(result.scene().chain.spheres));
}

TEST(Quantities, ThePressureOfAPlateInAFluidIsNamedAsTheSpectrumToCompareWith) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.output.duration_s = 0.2e-3;
    scene.drive.cycles = 5;
    std::string headings;
    for (const SummaryGroup& group : summary_of(run(scene, {.measured = Tap::p_axis}))) {
        headings += group.heading + '\n';
    }
    EXPECT_THAT(headings, testing::HasSubstr("spectrum of v_out, the velocity of the face"));
    EXPECT_THAT(headings, testing::HasSubstr("\np_axis, the pressure at the hydrophone"));
    EXPECT_EQ(summary_of(run(Scene()))[1].heading, "spectrum of v_out");
}

}  // namespace
}  // namespace hertzline
