#include "studies/field.hpp"

#include <atomic>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/simulation.hpp"
#include "hertzline/spectrum.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::studies {
namespace {

using testing::HasSubstr;

Scene wet_scene() {
    Scene scene;
    scene.end.model = PlateModel::modal;
    scene.drive.cycles = 3;
    scene.output.duration_s = 60e-6;
    scene.numerics.integrator = Integrator::taylor8;
    scene.numerics.step_s = 1e-7;
    scene.numerics.poles = 40;
    return scene;
}

FieldGrid grid_of(const std::string& text) {
    return parse_grid(wet_scene(), text).value();
}

std::string fault_in(const std::string& text) {
    const auto grid = parse_grid(wet_scene(), text);
    return grid ? "none" : grid.error().front().message();
}

TEST(FieldGrid, HasXFastestThenYThenZ) {
    const FieldGrid grid = grid_of("z=1mm,4mm,x=-2mm..2mm:3,y=5mm..6mm:2");
    ASSERT_EQ(grid.size(), 12U);
    EXPECT_EQ(grid.point(0), (Point{-2e-3, 5e-3, 1e-3}));
    EXPECT_EQ(grid.point(1), (Point{0, 5e-3, 1e-3}));
    EXPECT_EQ(grid.point(3), (Point{-2e-3, 6e-3, 1e-3}));
    EXPECT_EQ(grid.point(11), (Point{2e-3, 6e-3, 4e-3}));
    EXPECT_EQ(grid.text(), "x=-0.002..0.002:lin:3,y=0.005..0.006:lin:2,z=0.001,0.004");
    EXPECT_EQ(parse_grid(wet_scene(), grid.text())->point(7), grid.point(7));
}

TEST(FieldGrid, MayBeALineOrAPointOnTheAxis) {
    const FieldGrid line = grid_of("z=1mm..100mm:3:log");
    ASSERT_EQ(line.size(), 3U);
    EXPECT_NEAR(line.point(1)[2], 10e-3, 1e-12);
    EXPECT_EQ(grid_of("z=0").point(0), Point{});
}

TEST(FieldGrid, NamesWhatIsWrong) {
    EXPECT_THAT(fault_in(""), HasSubstr("allowed: x, y and z once each"));
    EXPECT_THAT(fault_in("x=1mm..2mm:5"), HasSubstr("with z"));
    EXPECT_THAT(fault_in("z=0,r=1mm"), HasSubstr("found \"r=1mm\", allowed: x, y and z once each"));
    EXPECT_THAT(fault_in("z=0,z=1mm"), HasSubstr("once each"));
    EXPECT_EQ(fault_in("z"), "found \"z\", allowed: x, y and z once each, as x=-8mm..8mm:81 or z=10mm");
    EXPECT_EQ(fault_in("z="), "z: found \"\", allowed: a number from 0 to 10 m");
    EXPECT_EQ(fault_in("z=-1mm..1mm:3"), "z: found \"-1mm\", allowed: a number from 0 to 10 m");
    EXPECT_EQ(fault_in("x=20,z=0"), "x: found 20, allowed: a number from -10 to 10 m");
    EXPECT_THAT(fault_in("z=1s"),
                HasSubstr("z: found \"1s\", allowed: a number from 0 to 10 m (m, with any"));
    EXPECT_EQ(fault_in("z=0,y=2mm..1mm:3"),
              "y: found \"2mm..1mm\", allowed: a range that goes up: FROM below TO");
    EXPECT_EQ(fault_in("x=-8..8mm:5,z=0"),
              "x: found \"-8\" beside a number with a unit, allowed: a unit after each number but 0");
    EXPECT_THAT(fault_in("z=1,2mm"), HasSubstr("z: found \"1\" beside a number with a unit"));
    EXPECT_EQ(fault_in("z=0..1mm:0"), "z: found \"0\", allowed: a count from 2 to 100000000");
    EXPECT_EQ(fault_in("z=0..1mm"), "z: found \"0..1mm\", allowed: z=FROM..TO:COUNT[:lin|log] or z=A,B,C");
    EXPECT_EQ(fault_in("z=1mm,1000um"), "z: found \"1000um\", allowed: each value once");
    EXPECT_EQ(parse_grid(wet_scene(), "x=1kg,z=-1").error().size(), 2U);
    EXPECT_THAT(fault_in("z=0..1:4000,x=0..1:4000"),
                HasSubstr("found 16000000 points, allowed: 1000000 at most"));
}

TEST(Field, IsThatOfARunWithAllPointsWhateverTheThreads) {
    Scene scene = wet_scene();
    const FieldGrid grid = grid_of("x=1mm..8mm:10,z=0..5mm:6");
    for (std::size_t i = 0; i < grid.size(); ++i) {
        scene.output.points_m.push_back(grid.point(i));
    }
    Simulation simulation(scene, {.taps = Tap::p_points});
    Samples samples = simulation.make_samples(601);
    ASSERT_EQ(simulation.advance(samples, 601), Status::running);
    const std::size_t points = grid.size();
    for (const int jobs : test::sanitized ? std::vector{3} : std::vector{1, 3}) {
        std::map<std::size_t, FieldPoint> field;
        run_field(scene, jobs, std::atomic<bool>(false),
                  [&](const FieldPoint& point) { EXPECT_TRUE(field.emplace(point.number, point).second); });
        ASSERT_EQ(field.size(), points);
        for (const auto& [number, point] : field) {
            ASSERT_EQ(point.pressure_pa.size(), 601U);
            double wrong = 0;
            double norm = 0;
            double peak = 0;
            for (std::size_t i = 0; i < 601; ++i) {
                const double expected = samples[Tap::p_points][i * points + number];
                wrong += std::pow(point.pressure_pa[i] - expected, 2);
                norm += expected * expected;
                peak = std::max(peak, std::abs(point.pressure_pa[i]));
            }
            EXPECT_LT(std::sqrt(wrong), 1e-5 * std::sqrt(norm)) << number;  // intervals have other lengths
            EXPECT_EQ(point.peak_pa, peak);
            EXPECT_NEAR(point.rms_pa, std::sqrt(norm / 601), 1e-5 * peak);
        }
        SpectrumAnalyser analyser(601, scene.output.sample_rate_hz);
        EXPECT_EQ(field.at(20).harmonics_pa,
                  analyser.harmonics(field.at(20).pressure_pa, scene.drive.frequency_hz));
    }
}

TEST(Field, StopsAndReportsFaults) {
    Scene scene = wet_scene();
    scene.output.points_m = {{0, 0, 0.01}};
    int taken = 0;
    run_field(scene, 2, std::atomic<bool>(true), [&](const FieldPoint&) { ++taken; });
    EXPECT_EQ(taken, 0);
    EXPECT_THROW(run_field(scene, 2, std::atomic<bool>(false),
                           [](const FieldPoint&) { throw std::runtime_error("full"); }),
                 std::runtime_error);
}

}  // namespace
}  // namespace hertzline::studies
