// A chain on a modal plate in water, against an independent solver and physical laws.

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "core/model/chain.hpp"
#include "core/model/energy.hpp"
#include "core/plate/quadrature.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"
#include "tests/support/modal_scenes.hpp"
#include "tests/support/reference.hpp"

namespace hertzline::test {
namespace {

constexpr TapSet outputs = TapSet(Tap::v_last) | Tap::v_centre | Tap::v_face | Tap::p_axis | Tap::f_last;

/// Returns all samples of a run.
Samples whole_run(Simulation& simulation, std::size_t rows) {
    Samples samples = simulation.make_samples(rows);
    EXPECT_EQ(simulation.advance(samples, rows), Status::running) << simulation.failure();
    return samples;
}

class EveryWetReference : public ::testing::TestWithParam<Wet> {
protected:
    /// Returns the largest relative L2 error of the columns.
    static double error_of(const Scene& scene, const Columns& reference) {
        const Resolution settled = resolve(scene);
        EXPECT_TRUE(settled.faults.empty());
        Simulation simulation(settled.scene, {.taps = outputs | Tap::p_points});
        const std::size_t rows = reference.at("t_s").size();
        const Samples samples = whole_run(simulation, rows);
        double largest = 0;
        for (const Tap tap : {Tap::v_last, Tap::v_centre, Tap::v_face, Tap::p_axis}) {
            const double error = relative_l2(samples[tap], reference.at(std::string(row_of(tap).column)));
            largest = std::max(largest, error);
        }
        const std::size_t points = scene.output.points_m.size();
        for (std::size_t point = 0; point < points; ++point) {
            std::vector<double> pressure(rows);
            for (std::size_t i = 0; i < rows; ++i) {
                pressure[i] = samples[Tap::p_points][i * points + point];
            }
            const double error =
                relative_l2(pressure, reference.at("p_" + std::to_string(point + 1) + "_pa"));
            largest = std::max(largest, error);
        }
        return largest;
    }
};

INSTANTIATE_TEST_SUITE_P(Scenes, EveryWetReference, ::testing::ValuesIn(wet_scenes()),
                         [](const auto& instance) { return std::string(instance.param.file); });

TEST_P(EveryWetReference, TheAccuracyAskedForIsKept) {
    const Columns reference = read_columns(GetParam().file);
    for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6}) {
        Scene scene = GetParam().scene;
        scene.numerics.accuracy = accuracy;
        EXPECT_LE(error_of(scene, reference), accuracy);
    }
}

TEST_P(EveryWetReference, TheLedgerCloses) {
    Scene scene = GetParam().scene;
    for (const double accuracy : {1e-4, 1e-8}) {
        scene.numerics.accuracy = accuracy;
        Simulation simulation(resolve(scene), {.taps = outputs});
        whole_run(simulation, 5001);
        const Ledger ledger = simulation.ledger();
        EXPECT_LE(simulation.energy_residual(), accuracy) << accuracy;
        EXPECT_GT(ledger.passed, 0);
        EXPECT_GT(ledger.plate_lost, 0);
        EXPECT_GE(ledger.plate_held, 0);
        EXPECT_LE(ledger.passed + ledger.lost, ledger.work * (1 + accuracy));
        if (scene.medium.load == FluidLoad::none) {
            EXPECT_NEAR(ledger.radiated(), 0, 100 * accuracy * ledger.passed);
        } else {
            EXPECT_GT(ledger.radiated(), 0.1 * ledger.passed);
        }
    }
}

TEST(ModalPlate, StaysAtRestUnderItsPreload) {
    Scene scene = modal_scene();
    scene.drive.amplitude_m = 0;
    Simulation simulation(resolve(scene), {.taps = outputs});
    const Samples samples = whole_run(simulation, 2000);
    for (const Tap tap : {Tap::v_last, Tap::v_centre, Tap::v_face, Tap::p_axis}) {
        for (const double value : samples[tap]) {
            ASSERT_EQ(value, 0) << row_of(tap).name;
        }
    }
}

TEST(ModalPlate, NothingIsHeardBeforeTheSoundHasCome) {
    const Scene scene = modal_scene();
    Simulation simulation(resolve(scene), {.taps = outputs});
    const Samples samples = whole_run(simulation, 2000);
    const double travel = scene.output.hydrophone_m / 1482 * scene.output.sample_rate_hz;
    const auto silent = static_cast<std::size_t>(travel);
    for (std::size_t i = 0; i <= silent; ++i) {
        ASSERT_EQ(samples[Tap::p_axis][i], 0) << i;
    }
    // then it is: the plate moves after a piece or two, however little
    EXPECT_NE(samples[Tap::p_axis][silent + 20], 0);
    EXPECT_NE(samples[Tap::v_centre][20], 0);
}

TEST(ModalPlate, BlocksOfAnySizeAndSkippedStretchesGiveTheSameSamples) {
    Scene scene = resolve(modal_scene()).scene;
    scene.drive.repetition_hz = 2000;
    Simulation whole(scene, {.taps = outputs});
    constexpr std::size_t rows = 12000;
    const Samples expected = whole_run(whole, rows);
    Simulation parts(scene, {.taps = outputs});
    expect_parts_to_match(parts, expected, rows, outputs);
    whole.reset();
    const Samples again = whole_run(whole, rows);
    for (const Tap tap : outputs) {
        EXPECT_TRUE(std::ranges::equal(again[tap], expected[tap])) << row_of(tap).name;
    }
}

/// Returns the Fourier sum of a record at a frequency.
std::complex<double> line(std::span<const double> values, double frequency_hz, double rate_hz) {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        sum += values[i] *
               std::polar(1.0, -2 * std::numbers::pi * frequency_hz * static_cast<double>(i) / rate_hz);
    }
    return sum;
}

class ModalPlateWithLaw : public ::testing::TestWithParam<DampingLaw> {
protected:
    static Scene scene_with_law() {
        Scene scene = modal_scene();
        scene.chain.damping_law = GetParam();
        scene.chain.damping_time_s = 3e-7;
        scene.chain.damping_alpha = 0.3;
        return scene;
    }
};
INSTANTIATE_TEST_SUITE_P(Laws, ModalPlateWithLaw, ::testing::ValuesIn(choices<DampingLaw>),
                         [](const auto& instance) { return std::string(word(instance.param)); });

TEST_P(ModalPlateWithLaw, AnswersToItsForceAsTheExactPlateDoes) {
    // one sphere, which never leaves the plate, and a short burst: the force is smooth, so its samples have its spectrum
    Scene scene = scene_with_law();
    scene.end.theory = PlateTheory::thin;
    scene.chain.spheres = 1;
    scene.drive.amplitude_m = 1e-9;
    scene.drive.frequency_hz = 220e3;
    scene.drive.cycles = 1;
    scene.output.duration_s = 20e-3;
    scene.numerics.accuracy = 1e-7;
    const double rate = scene.output.sample_rate_hz;
    Simulation simulation(resolve(scene), {.taps = outputs});
    const Samples samples = whole_run(simulation, 200001);
    std::vector<double> force(samples[Tap::f_last].begin(), samples[Tap::f_last].end());
    for (double& f : force) {
        f -= scene.chain.preload_n;
    }
    const auto plate = simulation.chain().end.plate;
    ASSERT_EQ(simulation.contact_events(), 0);
    constexpr std::array kilopascals{12.51, 18.75, 24.57, 100.49, 31.75, 26.82};
    for (std::size_t k = 0; k < kilopascals.size(); ++k) {
        const double f = 73e3 * static_cast<double>(k + 1);
        const std::complex<double> push = line(force, f, rate);
        EXPECT_NEAR(std::abs(line(samples[Tap::p_axis], f, rate) / push) / 1e3, kilopascals[k],
                    2e-3 * kilopascals[k])
            << k;
        const auto expected = value_at(plate->poles, plate->centre_m_per_s, {0, 2 * std::numbers::pi * f});
        EXPECT_LT(std::abs(line(samples[Tap::v_centre], f, rate) / push - expected),
                  2e-3 * std::abs(expected))
            << k;
    }
}

TEST(ModalPlate, ThePressureDoesNotHangOnTheSampleRate) {
    const auto at_rate = [](double rate_hz, std::size_t every) {
        Scene scene = modal_scene();
        scene.numerics.accuracy = 1e-5;
        scene.output.sample_rate_hz = rate_hz;
        Simulation simulation(resolve(scene), {.taps = outputs});
        const Samples samples = whole_run(simulation, 2000 * every + 1);
        std::vector<double> values;
        for (std::size_t i = 0; i <= 2000; ++i) {
            values.push_back(samples[Tap::p_axis][i * every]);
        }
        return values;
    };
    const std::vector<double> expected = at_rate(5e6, 1);
    EXPECT_LT(relative_l2(at_rate(10e6, 2), expected), 2e-5);
    EXPECT_LT(relative_l2(at_rate(40e6, 8), expected), 2e-5);
}

TEST(ModalPlate, APointOnTheAxisHearsTheSameAsTheHydrophone) {
    Scene scene = modal_scene();
    scene.output.points_m = {{0, 0, scene.output.hydrophone_m}, {0, 0, 0.1}, {0.03, -0.04, 0}, {0, 0, 0}};
    const ResolvedScene resolved = resolve(scene);
    Simulation simulation(resolved, {.taps = outputs | Tap::p_points});
    const Samples samples = whole_run(simulation, 2001);
    std::vector<double> first;
    for (std::size_t i = 0; i < samples.count; ++i) {
        first.push_back(samples[Tap::p_points][i * 4]);
    }
    EXPECT_EQ(relative_l2(first, samples[Tap::p_axis]), 0);
    Simulation alone(resolved, {.taps = Tap::p_axis});  // with intervals of its own
    EXPECT_LT(relative_l2(first, whole_run(alone, 2001)[Tap::p_axis]), 1e-5);
    Simulation parts(resolved, {.taps = outputs | Tap::p_points});
    expect_parts_to_match(parts, samples, 2001, Tap::p_points);
}

TEST(ModalPlate, TheEnergyThroughAHemisphereIsTheRadiatedOne) {
    Scene scene = modal_scene();
    scene.drive.cycles = 5;
    constexpr double distance = 0.2;
    std::vector<double> shares;  // of the hemisphere
    each_node<24>(0, 1, [&](double cosine, double weight) {
        scene.output.points_m.push_back({distance * std::sqrt(1 - cosine * cosine), 0, distance * cosine});
        shares.push_back(weight);
    });
    Simulation simulation(resolve(scene), {.taps = Tap::p_points});
    constexpr std::size_t rows = 9001;
    const Samples samples = whole_run(simulation, rows);
    double energy = 0;
    for (std::size_t i = 0; i < samples[Tap::p_points].size(); ++i) {
        const double p = samples[Tap::p_points][i];
        energy += shares[i % shares.size()] * p * p;
    }
    const Fluid fluid = simulation.chain().end.plate->parameters.fluid;
    energy *= 2 * std::numbers::pi * distance * distance /
              (fluid.density_kg_per_m3 * fluid.sound_speed_m_per_s * scene.output.sample_rate_hz);
    const double radiated = simulation.ledger().radiated();
    EXPECT_NEAR(energy, radiated, 5e-3 * radiated);
}

TEST(ModalPlate, PointsAtTheSameDistanceFromTheAxisHearTheSame) {
    Scene scene = modal_scene();
    scene.output.points_m = {{3e-3, 4e-3, 7e-3}, {-5e-3, 0, 7e-3}};
    Simulation simulation(resolve(scene), {.taps = Tap::p_points});
    const Samples samples = whole_run(simulation, 2001);
    for (std::size_t i = 0; i < samples.count; ++i) {
        ASSERT_EQ(samples[Tap::p_points][2 * i], samples[Tap::p_points][2 * i + 1]) << i;
    }
    EXPECT_GT(std::ranges::max(samples[Tap::p_points]), 100);
}

TEST(ModalPlate, OneModeInAVacuumIsAMassOnASpring) {
    // beside the paper's plate with the same mass and stiffness
    Scene modal = modal_scene();
    modal.end.theory = PlateTheory::thin;
    modal.end.modes = 1;
    modal.end.loss_factor = 1e-6;
    modal.medium.load = FluidLoad::none;
    modal.numerics.accuracy = 1e-7;
    Simulation simulation(resolve(modal), {.taps = outputs});
    const PlateMode mode = simulation.chain().end.plate->modes[0];
    Scene lumped;
    lumped.end.stiffness_n_per_m = mode.stiffness_n_per_m;
    // a quarter of the disc moves: its density is such that this is the mode's mass
    Solid disc = std::get<Solid>(*find_material(lumped, "vitreous_carbon"));
    const double quarter = disc.density_kg_per_m3 * std::numbers::pi * lumped.end.radius_m *
                           lumped.end.radius_m * lumped.end.thickness_m / 4;
    disc.density_kg_per_m3 *= mode.mass_kg / quarter;
    lumped.materials["disc"] = disc;
    lumped.end.material = "disc";
    lumped.numerics.accuracy = 1e-7;
    Simulation other(resolve(lumped), {.taps = TapSet(Tap::v_last) | Tap::v_plate});
    const Samples a = whole_run(simulation, 5001);
    const Samples b = whole_run(other, 5001);
    EXPECT_LT(relative_l2(a[Tap::v_last], b[Tap::v_last]), 3e-6);  // the loss factor is 1e-6
    EXPECT_LT(relative_l2(a[Tap::v_centre], b[Tap::v_plate]), 3e-6);
}

TEST(ModalPlate, OneSphereAndNoPreloadWorkToo) {
    for (const double preload : {0.0, 0.1, 10.0}) {
        Scene scene = modal_scene();
        scene.chain.spheres = 1;
        scene.chain.preload_n = preload;
        Simulation simulation(resolve(scene), {.taps = outputs});
        whole_run(simulation, 5001);
        EXPECT_LE(simulation.energy_residual(), 1e-3) << preload;
    }
}

TEST(ModalPlate, APlateThatTheChainLeavesRingsDown) {
    Scene scene = modal_scene();
    scene.chain.preload_n = 0;
    scene.drive.cycles = 1;
    scene.output.duration_s = 2e-3;
    Simulation simulation(resolve(scene), {.taps = outputs});
    const Samples samples = whole_run(simulation, 20001);
    const auto force = samples[Tap::f_last];
    EXPECT_GT(*std::ranges::max_element(force), 0.1);
    EXPECT_LT(std::ranges::max(force.last(2000)), 1e-3);
    const auto rms = [&](std::size_t from) {
        double sum = 0;
        for (const double v : samples[Tap::v_centre].subspan(from, 2000)) {
            sum += v * v;
        }
        return std::sqrt(sum);
    };
    EXPECT_LT(rms(18000), 0.5 * rms(4000));
    EXPECT_GT(rms(18000), 0);
}

TEST(ModalPlate, LongChainsReachItToo) {
    Scene scene = modal_scene();
    scene.chain.spheres = 120;
    scene.output.duration_s = 1e-3;
    scene.numerics.accuracy = 1e-5;  // the two take other pieces
    Simulation tracked(resolve(scene), {.taps = outputs});
    Simulation untracked(tracked.scene(), {.taps = outputs, .tracking = WavefrontTracking::off});
    const Samples a = whole_run(tracked, 10001);
    const Samples b = whole_run(untracked, 10001);
    EXPECT_GT(std::ranges::max(a[Tap::p_axis]), 0);
    EXPECT_LT(relative_l2(a[Tap::p_axis], b[Tap::p_axis]), 1e-6);
}

}  // namespace
}  // namespace hertzline::test
