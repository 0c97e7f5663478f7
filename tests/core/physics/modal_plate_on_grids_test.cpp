// A chain on a modal plate by leapfrog and chin4a: against the series, against an independent solver, and against what must hold.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/integrators/simd/target_choice.hpp"
#include "core/integrators/stability.hpp"
#include "core/scene/scene_words.hpp"
#include "core/simulation.hpp"
#include "core/step_choice/resolve.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/modal_scenes.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

constexpr TapSet outputs = TapSet(Tap::v_last) | Tap::v_centre | Tap::v_face | Tap::p_axis;
constexpr std::array grids{Integrator::leapfrog, Integrator::chin4a};

Samples run_of(Simulation& simulation, std::size_t rows) {
    Samples samples = simulation.make_samples(rows);
    EXPECT_EQ(simulation.advance(samples, rows), Status::running) << simulation.failure();
    return samples;
}

/// So small that no contact opens: then the motion is smooth.
Scene smooth_wet_scene() {
    Scene scene = modal_scene();
    scene.drive.amplitude_m = 1e-8;
    scene.numerics.poles = 40;
    return scene;
}

class ModalPlateOnGrid : public ::testing::TestWithParam<Integrator> {
protected:
    static int order() { return method(GetParam()).order; }
    static Scene stepped(const Scene& scene, double step_s) { return with_step(scene, GetParam(), step_s); }
};
INSTANTIATE_TEST_SUITE_P(Grids, ModalPlateOnGrid, ::testing::ValuesIn(grids), integrator_name);

TEST_P(ModalPlateOnGrid, ErrorsFallWithTheMethodsOrder) {
    constexpr std::size_t rows = 4001;
    Scene exact = smooth_wet_scene();
    exact.numerics.accuracy = 1e-10;
    Simulation reference(exact, {.taps = outputs});
    const Samples expected = run_of(reference, rows);
    std::map<Tap, std::vector<double>> errors;
    constexpr std::array steps{160e-9, 80e-9, 40e-9, 20e-9};
    for (const double step : steps) {
        Simulation simulation(stepped(smooth_wet_scene(), step), {.taps = outputs});
        const Samples samples = run_of(simulation, rows);
        for (const Tap tap : outputs) {
            errors[tap].push_back(relative_l2(samples[tap], expected[tap]));
        }
    }
    for (const auto& entry : errors) {
        const Tap tap = entry.first;
        const std::vector<double>& error = entry.second;
        const auto fall = [&error](std::size_t from, std::size_t to) {
            return std::log2(error[from] / error[to]) / static_cast<double>(to - from);
        };
        if (tap == Tap::p_axis) {  // looks into steps, where errors are larger or smaller than at their ends
            EXPECT_GT(fall(0, steps.size() - 1), order() - 0.2);
            continue;
        }
        for (std::size_t i = 1; i < steps.size(); ++i) {
            EXPECT_NEAR(fall(i - 1, i), order(), 0.15) << row_of(tap).name << ' ' << steps[i];
        }
    }
}

TEST_P(ModalPlateOnGrid, TheLedgerClosesWithTheMethodsOrder) {
    double before = 0;
    for (const double step : {160e-9, 80e-9, 40e-9}) {
        Simulation simulation(stepped(smooth_wet_scene(), step), {.taps = outputs});
        run_of(simulation, 4001);
        const double residual = simulation.energy_residual();
        if (before > 0) {
            EXPECT_NEAR(std::log2(before / residual), order(), 0.2) << step;
        }
        before = residual;
    }
}

TEST_P(ModalPlateOnGrid, TheLedgerSaysWhereThePowerGoes) {
    for (const Wet& wet : wet_scenes()) {
        Simulation series(with_integrator(wet.scene, Integrator::taylor12, 1e-8), {.taps = outputs});
        run_of(series, 5001);
        Simulation simulation(stepped(series.scene(), 12.5e-9), {.taps = outputs});
        run_of(simulation, 5001);
        const Ledger expected = series.ledger();
        const Ledger ledger = simulation.ledger();
        const double share = GetParam() == Integrator::leapfrog ? 1e-3 : 1e-5;
        EXPECT_NEAR(ledger.passed, expected.passed, share * expected.passed) << wet.file;
        EXPECT_NEAR(ledger.plate_lost, expected.plate_lost, share * expected.passed) << wet.file;
        EXPECT_NEAR(ledger.plate_held, expected.plate_held, share * expected.passed) << wet.file;
        EXPECT_NEAR(ledger.radiated(), expected.radiated(), share * expected.passed) << wet.file;
    }
}

TEST_P(ModalPlateOnGrid, KeepsTheAccuracyAskedForAndEstimatesItsError) {
    const std::vector<double> accuracies = GetParam() == Integrator::leapfrog
                                               ? std::vector{1e-2, 1e-3}
                                               : std::vector{1e-3, default_accuracy, 1e-5};
    for (const Wet& wet : wet_scenes()) {
        const Columns reference = read_columns(wet.file);
        for (const double accuracy : accuracies) {
            const ResolvedScene settled = resolve(with_integrator(wet.scene, GetParam(), accuracy));
            ASSERT_TRUE(settled.faults.empty());
            ASSERT_TRUE(settled.estimate);
            EXPECT_EQ(*settled.scene.numerics.integrator, GetParam());
            Simulation simulation(settled.scene, {.taps = outputs});
            const Samples samples = run_of(simulation, reference.at("t_s").size());
            double error = 0;
            for (const Tap tap : outputs) {
                const std::vector<double>& column = reference.at(std::string(row_of(tap).column));
                error = std::max(error, relative_l2(samples[tap], column));
            }
            EXPECT_LE(error, accuracy) << wet.file;
            EXPECT_LE(settled.estimate->error, accuracy) << wet.file;
            EXPECT_LE(error, 1.2 * settled.estimate->error) << wet.file;
        }
    }
}

TEST_P(ModalPlateOnGrid, StaysAtRestUnderItsPreload) {
    Scene scene = modal_scene();
    scene.drive.amplitude_m = 0;
    Simulation simulation(stepped(scene, 30e-9), {.taps = outputs});
    const Samples samples = run_of(simulation, 2000);
    for (const Tap tap : outputs) {
        EXPECT_TRUE(std::ranges::all_of(samples[tap], [](double v) { return v == 0; })) << row_of(tap).name;
    }
}

TEST_P(ModalPlateOnGrid, BlocksOfAnySizeAndSkippedStretchesGiveTheSameSamples) {
    constexpr std::size_t rows = 6000;
    Scene scene = modal_scene();
    scene.drive.repetition_hz = 2000;
    scene.drive.cycles = 10;
    for (const double step : {25e-9, 100e-9, 37e-9, 150e-9}) {  // on samples, and off them
        Simulation whole(stepped(scene, step), {.taps = outputs});
        const Samples expected = run_of(whole, rows);
        Simulation parts(stepped(scene, step), {.taps = outputs});
        expect_parts_to_match(parts, expected, rows, outputs);
        whole.reset();
        const Samples again = run_of(whole, rows);
        for (const Tap tap : outputs) {
            EXPECT_TRUE(std::ranges::equal(again[tap], expected[tap])) << row_of(tap).name;
        }
    }
}

TEST_P(ModalPlateOnGrid, WhatIsAskedForChangesNoSample) {
    const Scene scene = stepped(modal_scene(), 40e-9);
    Simulation all(scene, {.taps = outputs});
    Simulation one(scene, {.taps = Tap::v_centre});
    Simulation pressure(scene, {.taps = Tap::p_axis});
    const Samples expected = run_of(all, 3000);
    EXPECT_TRUE(std::ranges::equal(run_of(one, 3000)[Tap::v_centre], expected[Tap::v_centre]));
    EXPECT_TRUE(std::ranges::equal(run_of(pressure, 3000)[Tap::p_axis], expected[Tap::p_axis]));
}

TEST_P(ModalPlateOnGrid, SamplesDoNotHangOnTheSampleRate) {
    const auto at_rate = [&](double rate_hz, std::size_t every) {
        Scene scene = stepped(smooth_wet_scene(), 30e-9);
        scene.output.sample_rate_hz = rate_hz;
        Simulation simulation(scene, {.taps = outputs});
        const Samples samples = run_of(simulation, 1500 * every + 1);
        std::map<Tap, std::vector<double>> values;
        for (const Tap tap : outputs) {
            for (std::size_t i = 0; i <= 1500; ++i) {
                values[tap].push_back(samples[tap][i * every]);
            }
        }
        return values;
    };
    // 30 ns divide none of the periods but the last
    const auto expected = at_rate(5e6, 1);
    for (const std::size_t every : {2, 8, 80}) {
        auto values = at_rate(5e6 * static_cast<double>(every), every);
        for (const Tap tap : outputs) {
            EXPECT_LT(relative_l2(values[tap], expected.at(tap)), 1e-5) << row_of(tap).name << ' ' << every;
        }
    }
}

TEST_P(ModalPlateOnGrid, LongChainsReachItToo) {
    Scene scene = modal_scene();
    scene.chain.spheres = 300;  // more than are laid out at the start
    scene.output.sample_rate_hz = 2.5e6;
    scene = stepped(scene, 200e-9);
    Simulation tracked(scene, {.taps = outputs});
    Simulation untracked(scene, {.taps = outputs, .tracking = WavefrontTracking::off});
    const Samples a = run_of(tracked, 6001);
    const Samples b = run_of(untracked, 6001);
    EXPECT_GT(std::ranges::max(a[Tap::p_axis]), 0);
    for (const Tap tap : outputs) {
        EXPECT_LT(relative_l2(a[tap], b[tap]), GetParam() == Integrator::leapfrog ? 1e-300 : 1e-9);
    }
}

TEST_P(ModalPlateOnGrid, OneSphereAnyPreloadAndNoTensionWorkToo) {
    for (const double preload : {0.0, 0.1, 10.0}) {
        for (const Tension tension : {Tension::allowed, Tension::clamped}) {
            Scene scene = modal_scene();
            scene.chain.spheres = 1;
            scene.chain.preload_n = preload;
            scene.chain.tension = tension;
            Simulation series(with_integrator(scene, Integrator::taylor12, 1e-8), {.taps = outputs});
            const Samples expected = run_of(series, 5001);
            Simulation simulation(stepped(series.scene(), 10e-9), {.taps = outputs});
            const Samples samples = run_of(simulation, 5001);
            EXPECT_LE(simulation.energy_residual(), 1e-3) << preload;
            const double bound = GetParam() == Integrator::leapfrog ? 2e-2 : 1e-4;
            EXPECT_LE(relative_l2(samples[Tap::v_centre], expected[Tap::v_centre]), bound) << preload;
        }
    }
}

TEST_P(ModalPlateOnGrid, APlateThatTheChainLeavesRingsDown) {
    Scene scene = modal_scene();
    scene.chain.preload_n = 0;
    scene.drive.cycles = 1;
    Simulation series(with_integrator(scene, Integrator::taylor12, 1e-8), {.taps = outputs});
    const Samples expected = run_of(series, 10001);
    Simulation simulation(stepped(series.scene(), 12.5e-9), {.taps = outputs | Tap::f_last});
    const Samples samples = run_of(simulation, 10001);
    EXPECT_LT(std::ranges::max(samples[Tap::f_last].last(2000)), 1e-3);
    EXPECT_GT(std::ranges::max(samples[Tap::v_centre].last(2000)), 0);
    for (const Tap tap : outputs) {
        EXPECT_LE(relative_l2(samples[tap], expected[tap]), 2e-2) << row_of(tap).name;
    }
}

TEST_P(ModalPlateOnGrid, IsStableUpToTheLimitWhateverItsModes) {
    for (const int modes : {1, 4, 6}) {
        for (const double thickness : {0.1e-3, 0.5e-3, 2.5e-3}) {
            Scene scene = modal_scene();
            scene.medium.load = FluidLoad::none;  // loses least
            scene.end.modes = modes;
            scene.end.loss_factor = 1e-6;
            scene.end.thickness_m = thickness;
            scene.chain.damping_kg_per_s = 0;
            scene.drive.cycles = 1;
            scene.drive.amplitude_m = 1e-9;  // presses the contacts no further
            const Chain chain(scene);
            const double limit = largest_stable_step(chain, chain.static_overlap, GetParam());
            scene = stepped(scene, 0.97 * limit);
            scene.output.sample_rate_hz = 0.1 / limit;
            Simulation simulation(scene, {.taps = outputs});
            const Samples samples = run_of(simulation, 2000);
            const auto loudest = [&](std::size_t from) {
                double largest = 0;
                for (const double v : samples[Tap::v_last].subspan(from, 500)) {
                    largest = std::max(largest, std::abs(v));
                }
                return largest;
            };
            EXPECT_LT(loudest(1500), 3 * loudest(0)) << modes << ' ' << thickness;
        }
    }
}

TEST_P(ModalPlateOnGrid, AStepBeyondTheLimitIsRefused) {
    Scene scene = modal_scene();
    const StepAdvice advice = advise_step(with_integrator(scene, GetParam(), default_accuracy));
    EXPECT_LT(advice.recommended_step_s, advice.largest_stable_step_s);
    EXPECT_EQ(resolve(stepped(scene, 0.99 * advice.largest_stable_step_s)).faults.size(), 0U);
    EXPECT_EQ(resolve(stepped(scene, 1.01 * advice.largest_stable_step_s)).faults.size(), 1U);
}

TEST_P(ModalPlateOnGrid, EveryInstructionSetGivesTheSame) {
    const Scene scene = stepped(smooth_wet_scene(), 40e-9);
    Simulation simulation(scene, {.taps = outputs});
    const Samples expected = run_of(simulation, 2000);
    for (const std::string& target : kernels::kernel_targets()) {
        ASSERT_TRUE(kernels::pin_kernel_target(target));
        Simulation other(scene, {.taps = outputs});
        const Samples samples = run_of(other, 2000);
        kernels::pin_kernel_target(kernels::kernel_targets().front());
        for (const Tap tap : outputs) {
            EXPECT_LT(relative_l2(samples[tap], expected[tap]), 1e-10) << target;
        }
    }
}

}  // namespace
}  // namespace hertzline::test
