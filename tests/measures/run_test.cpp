#include "hertzline/run.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/chain.hpp"
#include "core/model/energy.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/measuring.hpp"
#include "measures/run.hpp"
#include "tests/support/error_of.hpp"

namespace hertzline::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

TEST(Run, OfASceneIsThatOfItsResolution) {
    const Scene scene = read_scene("paper-vitreous-carbon");
    const hertzline::Run of_scene = run(scene);
    EXPECT_EQ(of_scene["peak_v_out_m_per_s"], run(resolve(scene))["peak_v_out_m_per_s"]);
    EXPECT_EQ(summary_json(of_scene)["peak_v_out_m_per_s"], of_scene["peak_v_out_m_per_s"]);
    EXPECT_THROW(of_scene["peak"], std::out_of_range);
}

TEST(Run, TheSummaryHasTheWarningsOfSceneAndResult) {
    Scene scene;
    scene.drive.taper = 0.3;  // without effect
    scene.output.duration_s = 100e-6;
    hertzline::Run done = run(scene);
    done.warnings = {"of the result"};
    EXPECT_THAT(summary_json(done)["warnings"].get<Warnings>(),
                AllOf(Contains(HasSubstr("drive.taper")), Contains("of the result")));
}

TEST(Run, OfASceneWithFaultsThrowsAllOfThem) {
    Scene scene;
    scene.chain.spheres = 0;
    scene.drive.frequency_hz = -1;
    const auto faults = AllOf(HasSubstr("chain.spheres: found 0"), HasSubstr("drive.frequency_hz: found -1"));
    EXPECT_THAT(error_of([&] { run(scene); }), faults);
    EXPECT_THAT(error_of([&] { run(resolve(scene)); }), faults);
    EXPECT_THAT(error_of([&] { const Simulation simulation(resolve(scene)); }), faults);
}

TEST(Run, RequestsThatItCannotMeetAreRefused) {
    Scene wall;
    wall.end.kind = EndKind::wall;
    EXPECT_THAT(error_of([&] { run(wall, {.measured = Tap::v_plate}); }),
                HasSubstr("found v_plate, allowed: v_out, v_last"));
    EXPECT_THROW(run(wall)["p_axis.thd_r"], std::out_of_range);
    EXPECT_THAT(
        error_of([&] { run(wall, {.measured = Tap::v_chain, .band_from_hz = -1}); }),
        AllOf(HasSubstr("found v_chain, allowed: v_out, v_last"), HasSubstr("band_from_hz: found -1")));
    const Resolution resolved = resolve(wall);
    Scene longer = resolved.scene;
    longer.chain.spheres = 7;
    const std::vector<SceneStep> other{{.sample = 10, .scene = longer}};
    EXPECT_THAT(error_of([&] { run(resolved, {.steps = other}); }), HasSubstr("other numbers of spheres"));
    const auto refusal = [&](const auto& change, std::int64_t sample = 10, bool continued = false) {
        Scene changed = resolved.scene;
        change(changed);
        const std::vector<SceneStep> steps{{.sample = sample, .continued = continued, .scene = changed}};
        return error_of([&] { run(resolved, {.steps = steps}); });
    };
    EXPECT_THAT(refusal([](Scene& scene) { scene.chain.material = "nope"; }),
                HasSubstr("chain.material: found \"nope\""));
    EXPECT_THAT(refusal([](Scene& scene) { scene.chain.preload_n = std::nan(""); }),
                HasSubstr("chain.preload_n: found nan"));
    EXPECT_THAT(refusal([](Scene& scene) { scene.output.sample_rate_hz = 1e6; }),
                HasSubstr("another sample rate"));
    EXPECT_THAT(refusal([](Scene& scene) { scene.end.kind = EndKind::plate; }), HasSubstr("other taps"));
    EXPECT_THAT(refusal([](Scene&) {}, -5), HasSubstr("found one from sample -5 on"));
    EXPECT_THAT(refusal([](Scene& scene) { scene.chain.diameter_m = 2e-3; }, 10, true),
                HasSubstr("cannot be continued"));
    const std::vector<SceneStep> back{{.sample = 20, .scene = resolved.scene},
                                      {.sample = 10, .scene = resolved.scene}};
    EXPECT_THAT(error_of([&] { run(resolved, {.steps = back}); }), HasSubstr("in their order"));
    Resolution edited = resolved;
    edited.scene.chain.material = "nope";
    edited.scene.chain.spheres = -1;
    EXPECT_THAT(error_of([&] { run(edited); }),
                AllOf(HasSubstr("chain.material: found"), HasSubstr("chain.spheres: found -1")));
    Scene array = read_scene("seven-chains");
    array.array.coupling = Coupling::none;
    const Resolution arrayed = resolve(array);
    const std::vector<SceneStep> on{{.sample = 10, .continued = true, .scene = arrayed.scene}};
    EXPECT_THAT(error_of([&] { run(arrayed, {.steps = on}); }), HasSubstr("cannot be continued"));
    Scene endless;
    endless.output.duration_s = 1e6;
    EXPECT_THAT(error_of([&] { run(endless); }),
                HasSubstr("output.duration_s: found 10000000000001 samples"));
}

TEST(Run, AMotionThatGoesOnKeepsTheEnergiesOfThoseBefore) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.drive.cycles = 1;
    const Resolution resolved = resolve(scene);
    const auto energies = [&resolved](double duration_s, const std::vector<SceneStep>& steps) {
        Resolution lasting = resolved;
        lasting.scene.output.duration_s = duration_s;
        return run(lasting, {.steps = steps}).plate.value();
    };
    const SceneStep anew{.sample = 300, .continued = false, .scene = resolved.scene};
    const auto on = [&](std::int64_t sample) { return SceneStep{sample, true, resolved.scene}; };
    const PlateEnergy all = energies(60e-6, {anew, on(450)});
    const PlateEnergy first = energies(29.9e-6, {});
    const PlateEnergy second = energies(30e-6, {on(150)});
    EXPECT_GT(first.passed, 0.1 * all.passed);
    EXPECT_NEAR(all.passed, first.passed + second.passed, 0.02 * all.passed);
    EXPECT_NEAR(all.lost, first.lost + second.lost, 0.02 * all.lost);
}

TEST(Run, TheDeflectionIsThatOfThePlatesOwnMotion) {
    Scene scene;
    scene.drive.amplitude_m = 20e-6;
    const Resolution resolved = resolve(scene);
    const hertzline::Run done = run(resolved);
    Simulation simulation(resolved);
    const double sag = simulation.chain().end_force_n / simulation.chain().end.body.spring;
    double largest = sag;
    for (std::size_t sample = 0; sample < done.rows(); ++sample) {
        ASSERT_EQ(simulation.skip(1), Status::running);
        const ChainState& state = simulation.state();
        largest = std::max(largest, std::abs(sag + state.x[state.x.size() - 1]));
    }
    EXPECT_GT(largest, 2 * sag);
    EXPECT_NEAR(done.deflection_m, largest, 0.01 * largest);
}

TEST(Run, ADiscThatThePreloadHasNotBentYetStartsFlat) {
    Scene scene = read_scene("paper-silicone-rubber");
    scene.end.preload = PlatePreload::as_printed;
    scene.chain.preload_n = 0.65;
    const hertzline::Run done = run(scene);
    EXPECT_NEAR(done.deflection_m, 5.8e-5, 0.2e-5);  // by an integrator of its own
}

TEST(Run, WarnsOfADiscThatTheMotionBendsTooFar) {
    const auto bends = testing::Contains(HasSubstr("the motion bends the disc by"));
    for (const PlateModel model : {PlateModel::lumped, PlateModel::modal}) {
        Scene scene;
        scene.end.model = model;
        scene.drive.cycles = 4;
        scene.output.duration_s = 100e-6;
        EXPECT_THAT(run(scene).warnings, testing::Not(bends));
        // F a^2 / (16 pi D) at rest, without the shear of a thick plate
        scene.end.theory = PlateTheory::thin;
        scene.chain.preload_n = 0.48 * Chain(Scene{}).end.body.spring * scene.end.thickness_m;
        scene.drive.amplitude_m = 1e-9;
        const hertzline::Run nearly = run(scene);
        EXPECT_NEAR(nearly.deflection_m, 0.48 * scene.end.thickness_m, 0.01 * scene.end.thickness_m);
        EXPECT_THAT(nearly.warnings, testing::Not(bends));
        scene.drive.amplitude_m = 60e-6;
        EXPECT_THAT(run(scene).warnings, bends);
        scene.output.sample_rate_hz = 1e6;  // too few samples in a period of the drive
        EXPECT_THAT(run(scene).warnings, testing::Not(bends));
    }
}

TEST(Run, TheNumbersOfEnergyAreThoseOfTheLedger) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.drive.horn = HornModel::resonator;
    scene.drive.horn_mass_kg = 0.01;
    scene.drive.cycles = 2;
    scene.chain.holder_time_s = 1e-3;
    scene.output.duration_s = 100e-6;
    const Resolution resolved = resolve(scene);
    const hertzline::Run done = run(resolved);
    Simulation simulation(resolved);
    ASSERT_EQ(simulation.skip(static_cast<std::int64_t>(done.rows())), Status::running);
    const Ledger ledger = simulation.ledger();
    const std::map<std::string, double> energies{
        {"horn_source_j", ledger.source_work}, {"horn_lost_j", ledger.horn_lost},
        {"horn_held_j", ledger.horn_held},     {"holder_lost_j", ledger.holder_lost},
        {"plate_passed_j", ledger.passed},     {"plate_lost_j", ledger.plate_lost},
        {"plate_held_j", ledger.plate_held},   {"radiated_j", ledger.radiated()},
    };
    const Json numbers = summary_json(done);
    for (const auto& [name, energy] : energies) {
        EXPECT_NE(energy, 0) << name;
        EXPECT_NEAR(numbers[name].get<double>(), energy, 1e-9 * std::abs(energy)) << name;
    }
    const auto joules = [&numbers](const char* name) { return numbers[name].get<double>(); };
    EXPECT_NEAR(joules("plate_lost_j") + joules("plate_held_j") + joules("radiated_j"),
                joules("plate_passed_j"), 1e-9 * joules("plate_passed_j"));
}

TEST(Run, ALedgerThatDoesNotCloseIsWarnedOf) {
    hertzline::Run done = run(read_scene("paper-wall"));
    const auto warnings = [&done](double residual) {
        done.energy_residual = residual;
        done.warnings.clear();
        measures::measure(done, nullptr, std::nullopt, nullptr);
        return done.warnings;
    };
    EXPECT_THAT(warnings(0.2),
                testing::Contains(HasSubstr("energy_residual is 0.2 of the energy that came")));
    EXPECT_THAT(warnings(std::numeric_limits<double>::quiet_NaN()),
                testing::Contains(HasSubstr("energy_residual is nan")));
    EXPECT_THAT(warnings(0.09), testing::Each(testing::Not(HasSubstr("energy_residual"))));
}

TEST(Run, TheFirstArrivalIsThatOfHalfThePeakAtTheFirstPoint) {
    hertzline::Run done = run(read_scene("paper-wall"));
    done.p_first = {0, 0.5, -1.9, -2.1, 4, 3};
    measures::measure(done, nullptr, std::nullopt, nullptr);
    EXPECT_EQ(done.first_arrival_s, 3 / done.scene().output.sample_rate_hz);
}

TEST(Run, TheFocalGainIsOverTheMiddleElementAlone) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.drive.cycles = 1;
    scene.output.duration_s = 60e-6;
    scene.output.points_m = {{2e-3, 0, 20e-3}};
    scene.array.x_m = {-11e-3, 1e-3, 12e-3};
    scene.array.y_m = {0, 0, 0};
    scene.array.coupling = Coupling::none;
    const hertzline::Run array = run(scene);
    scene.array = {};
    scene.output.points_m = {{1e-3, 0, 20e-3}};
    EXPECT_NEAR(array["focal_gain"], array["peak_p_points_pa"] / run(scene)["peak_p_points_pa"], 1e-3);
    EXPECT_GT(array["focal_gain"], 1.01);
}

TEST(Run, AStopIsHeededWhileTheMiddleElementIsSimulatedAlone) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.drive.cycles = 1;
    scene.output.duration_s = 60e-6;
    scene.output.points_m = {{0, 0, 20e-3}};
    scene.array.x_m = {-11e-3, 11e-3};
    scene.array.y_m = {0, 0};
    scene.array.coupling = Coupling::none;
    std::atomic<bool> stop = false;
    std::size_t rows = 0;
    const hertzline::Run stopped =
        run(resolve(scene), {.stop = &stop, .take = [&](const Samples& block) {
                                 rows += block.count;
                                 stop = rows == static_cast<std::size_t>(measures::rows_of_run(scene));
                                 return true;
                             }});
    EXPECT_TRUE(stopped.stopped);
    EXPECT_FALSE(stopped.alone_p_pa);
}

TEST(Run, PeaksOfAnArrayAreThoseOfItsMiddleElement) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.drive.cycles = 1;
    scene.output.duration_s = 50e-6;
    scene.array.x_m = {0, 30e-3};
    scene.array.y_m = {0, 0};
    scene.array.coupling = Coupling::none;
    scene.array.amplitudes_m = {0.1e-6, 3e-6};
    const hertzline::Run array = run(scene);
    scene.array = {};
    scene.drive.amplitude_m = 0.1e-6;
    EXPECT_NEAR(array["peak_v_last_m_per_s"], run(scene)["peak_v_last_m_per_s"],
                1e-3 * array["peak_v_last_m_per_s"]);
}

TEST(Run, ThePeakAtThePointsIsThatOfAllSamples) {
    Scene scene = read_scene("wet-vitreous-carbon");
    scene.drive.cycles = 3;
    scene.output.duration_s = 100e-6;
    EXPECT_TRUE(std::isnan(run(scene)["peak_p_points_pa"]));
    scene.output.points_m = {{0, 0, 0.01}, {0.001, 0, 0.002}};
    double peak = 0;
    const hertzline::Run all = run(scene, {.recorded = Tap::p_points, .take = [&](const Samples& block) {
                                               for (const double pressure : block[Tap::p_points]) {
                                                   peak = std::max(peak, std::abs(pressure));
                                               }
                                               return true;
                                           }});
    EXPECT_GT(peak, 0);
    EXPECT_EQ(all["peak_p_points_pa"], peak);
    EXPECT_EQ(run(scene)["peak_p_points_pa"], peak);
}

TEST(Run, GivesItsSamplesAsTheyCome) {
    std::size_t rows = 0;
    const hertzline::Run all =
        run(Scene{}, {.recorded = Tap::v_chain, .take = [&](const Samples& block) {
                          EXPECT_EQ(block[Tap::v_chain].size(), block.count * block.spheres());
                          rows += block.count;
                          return true;
                      }});
    EXPECT_EQ(rows, all.rows());
    const std::atomic<bool> stop = true;
    const hertzline::Run none = run(Scene{}, {.stop = &stop});
    EXPECT_TRUE(none.stopped);
    EXPECT_EQ(none.simulated_s(), 0);
    const hertzline::Run part =
        run(Scene{}, {.take = [](const Samples& block) { return block.first < 1000; }});
    EXPECT_TRUE(part.stopped);
    EXPECT_GT(part.steps, 0);
    EXPECT_GT(part.load.force_n, 0);
    EXPECT_LT(part.energy_residual, 1e-3);
}

}  // namespace
}  // namespace hertzline::test
