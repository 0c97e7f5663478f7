// Promises of every run, for any physics: rest, determinism, honesty about instability, no allocation.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/integrators/stability.hpp"
#include "core/model/energy.hpp"
#include "core/scene/scene_words.hpp"
#include "core/step_choice/step_advice.hpp"
#include "hertzline/resolve.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/records.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {
namespace {

constexpr double on_grid = 50e-9;
constexpr double off_grid = 70e-9;

/// Horns that move as a record does, and those on which the chain acts back.
void add_horns(Integrator integrator, std::vector<Scene>& scenes) {
    for (const std::int64_t spheres : {6, 150}) {
        Scene scene = with_step(Scene{}, integrator, on_grid);
        scene.chain.spheres = spheres;
        const auto burst = [](double t) {
            return 3e-6 * std::pow(std::sin(std::numbers::pi * t / 100e-6), 2) *
                   std::sin(2 * std::numbers::pi * 73e3 * t);
        };
        scene.drive = sampled(burst, 10e6, 100e-6);
        scenes.push_back(scene);
        if (is_series(integrator)) {
            scene.drive.horn = HornModel::resonator;
            scene.drive.horn_mass_kg = 1e-4;
            scenes.push_back(scene);
            scene.drive = Drive{};
            scene.drive.horn = HornModel::resonator;
            scene.drive.horn_mass_kg = 1e-5;
            scene.drive.horn_quality = 20;
            scenes.push_back(scene);
        }
    }
}

std::vector<Scene> every_kind() {
    std::vector<Scene> scenes;
    for (const Integrator integrator : choices<Integrator>) {
        for (const double step : {on_grid, off_grid}) {
            for (const EndKind end : {EndKind::plate, EndKind::wall, EndKind::free}) {
                for (const std::int64_t spheres : sanitized ? std::vector<std::int64_t>{1, 7, 40}
                                                            : std::vector<std::int64_t>{1, 6, 7, 40, 150}) {
                    Scene scene = with_step(Scene{}, integrator, step);
                    scene.end.kind = end;
                    scene.chain.spheres = spheres;
                    scenes.push_back(scene);
                }
            }
        }
        add_horns(integrator, scenes);
    }
    return scenes;
}

TEST(Promises, AChainAtRestStaysAtRestToTheLastBit) {
    for (Scene scene : every_kind()) {
        scene.drive.amplitude_m = 0;
        std::ranges::fill(scene.drive.samples, 0.0);
        const Record record = recorded(scene, 500);
        for (const double x : record.chain_x) {
            ASSERT_EQ(x, 0);
        }
        for (const double v : record.v_out) {
            ASSERT_EQ(v, 0);
        }
    }
}

TEST(Promises, ResultsDoNotDependOnBlockSize) {
    for (const Scene& scene : every_kind()) {
        Simulation whole(scene, {.taps = everything});
        const Record expected = recorded(whole, 700, 700);
        for (const std::size_t block : {1, 7, 64, 333}) {
            Simulation simulation(scene, {.taps = everything});
            ASSERT_EQ(recorded(simulation, 700, block), expected) << block;
            EXPECT_EQ(simulation.contact_events(), whole.contact_events());
            EXPECT_EQ(simulation.steps(), whole.steps());
            EXPECT_EQ(simulation.energy_residual(), whole.energy_residual());
        }
    }
}

TEST(Promises, WhatIsNotWantedDoesNotChangeWhatIs) {
    for (const Scene& scene : every_kind()) {
        const Record expected = recorded(scene, 900);
        Simulation without_ledger(scene, {.taps = everything, .ledger = LedgerKeeping::off});
        EXPECT_EQ(recorded(without_ledger, 900, 900), expected);
        Simulation simulation(scene, {.taps = everything});
        Samples part = simulation.make_samples(300);
        EXPECT_EQ(simulation.skip(300), Status::running);
        EXPECT_EQ(simulation.advance(part, 300, TapSet()), Status::running);
        EXPECT_EQ(part.count, 300U);
        EXPECT_EQ(simulation.advance(part, 300), Status::running);
        for (std::size_t i = 0; i < 300; ++i) {
            ASSERT_EQ(part[Tap::v_out][i], expected.v_out[600 + i]);
        }
    }
}

TEST(Promises, StepsTakenTogetherGiveTheBitsOfStepsTakenOneByOne) {
    // all velocities after each step: step by step; the outputs alone: long chains sweep many steps
    for (Scene scene : every_kind()) {
        scene.chain.spheres *= 5;
        Simulation one_by_one(scene, {.taps = everything});
        const Record expected = recorded(one_by_one, 900, 300);
        Simulation together(scene);
        Samples part = together.make_samples(900);
        EXPECT_EQ(together.advance(part, 900), Status::running);
        EXPECT_TRUE(std::ranges::equal(part[Tap::v_out], expected.v_out));
        EXPECT_TRUE(std::ranges::equal(part[Tap::v_last], expected.v_last));
        EXPECT_EQ(together.contact_events(), one_by_one.contact_events());
        EXPECT_EQ(together.energy_residual(), one_by_one.energy_residual());
        EXPECT_TRUE((together.state().peak_overlap == one_by_one.state().peak_overlap).all());
    }
}

TEST(Promises, EveryRunGivesTheSameBitsAlsoAfterReset) {
    for (const Scene& scene : every_kind()) {
        Simulation simulation(scene, {.taps = everything});
        const Record first = recorded(simulation, 400, 64);
        const double residual = simulation.energy_residual();
        const std::int64_t events = simulation.contact_events();
        simulation.reset();
        EXPECT_EQ(simulation.contact_events(), 0);
        EXPECT_EQ(simulation.ledger().work, 0);
        EXPECT_EQ(recorded(simulation, 400, 64), first);
        EXPECT_EQ(simulation.energy_residual(), residual);
        EXPECT_EQ(simulation.contact_events(), events);
        EXPECT_EQ(recorded(scene, 400), first);
    }
}

TEST(Promises, LookingAtStateAndLedgerChangesNothing) {
    for (const Scene& scene : every_kind()) {
        Simulation looked_at(scene, {.taps = everything});
        Samples part = looked_at.make_samples(10);
        Record record;
        for (int i = 0; i < 40; ++i) {
            EXPECT_EQ(looked_at.advance(part, 10), Status::running);
            append(record, part);
            (void)looked_at.energy_residual();
        }
        EXPECT_EQ(record, recorded(scene, 400));
    }
}

TEST(Promises, SpheresAheadOfTheWaveDoNotMatter) {
    // the wave has not reached the far end of a long chain: the near part moves as in an even longer one
    for (const Integrator integrator : choices<Integrator>) {
        Scene scene = with_step(Scene{}, integrator, on_grid);
        scene.end.kind = EndKind::wall;
        scene.chain.spheres = 400;
        const Record shorter = recorded(scene, 1000);
        scene.chain.spheres = 3000;
        const Record longer = recorded(scene, 1000);
        for (std::size_t i = 0; i < 1000; ++i) {
            for (std::size_t s = 0; s < 20; ++s) {
                // not bit for bit: forces are evaluated anew when more of the chain is taken in
                ASSERT_NEAR(shorter.chain_v[i * 400 + s], longer.chain_v[i * 3000 + s], 1e-11)
                    << i << ' ' << s;
            }
        }
    }
}

TEST(Promises, StifferContactsBeyondThePilotsMakeNoPieceCoarser) {
    // the last of these spheres are far smaller than those that pilots simulate
    Scene scene;
    scene.drive.cycles = 3;
    scene.end.kind = EndKind::wall;
    scene.chain.spheres = 1500;
    scene.chain.taper = 1e-3;
    scene.output.sample_rate_hz = 2e6;
    constexpr std::size_t samples = 201;
    const Record run = recorded(settled(scene), samples);
    const Record truth = recorded(with_step(scene, Integrator::taylor12, 30e-9), samples);
    double error = 0;
    double size = 0;
    for (std::size_t i = 0; i < run.chain_v.size(); ++i) {
        error += std::pow(run.chain_v[i] - truth.chain_v[i], 2);
        size += std::pow(truth.chain_v[i], 2);
    }
    EXPECT_LT(std::sqrt(error / size), default_accuracy);
}

/// Three discs that feel each other, two of them at one distance from the third.
Scene coupled_array() {
    Scene scene;
    scene.end.model = PlateModel::modal;
    scene.array.x_m = {0, 12e-3, 24e-3};
    scene.array.y_m = {0, 0, 0};
    scene.output.points_m = {{0, 0, 20e-3}, {5e-3, 0, 20e-3}};
    return resolve(scene).scene;
}

TEST(Promises, AdvancingAllocatesNothing) {
    if (HERTZLINE_ALLOCATIONS_ARE_COUNTED == 0) {
        GTEST_SKIP() << "sanitizers bring an allocator of their own";
    }
    std::vector<Scene> scenes = every_kind();
    scenes.push_back(coupled_array());
    for (const Scene& scene : scenes) {
        Simulation simulation(scene, {.taps = everything});
        Samples part = simulation.make_samples(64);
        const std::size_t before = allocations();
        for (int i = 0; i < 20; ++i) {
            EXPECT_EQ(simulation.advance(part, 64), Status::running);
            EXPECT_EQ(simulation.advance(part, 64), Status::running);
            EXPECT_EQ(simulation.skip(64), Status::running);
        }
        EXPECT_EQ(allocations() - before, 0U);
    }
}

TEST(Promises, ABlockOfAnotherSceneIsFilledWhereItFits) {
    const Scene scene = with_step(Scene{}, Integrator::leapfrog, 100e-9);
    Simulation simulation(scene, {.taps = TapSet(Tap::v_out) | Tap::v_chain});
    Samples longer(everything, {.spheres = 9, .points = 2, .elements = 1}, 64);
    ASSERT_EQ(simulation.advance(longer, 64), Status::running);
    EXPECT_EQ(longer.holds, TapSet(Tap::v_out));
    EXPECT_EQ(longer.count, 64U);
    EXPECT_THROW(Samples(Tap::v_chain, {.spheres = std::size_t{1} << 40U}, std::size_t{1} << 30U),
                 std::bad_alloc);
}

TEST(Promises, AnUnstableStepIsReportedAndGivesNoSamples) {
    for (const Integrator integrator : {Integrator::leapfrog, Integrator::chin4a}) {
        const Scene scene =
            with_step(Scene{}, integrator, integrator == Integrator::leapfrog ? 1.3e-6 : 2.5e-6);
        Simulation simulation(scene, {.taps = everything});
        Samples part = simulation.make_samples(64);
        Status status = Status::running;
        for (int i = 0; i < 100 && status == Status::running; ++i) {
            status = simulation.advance(part, 64);
            for (std::size_t s = 0; s < part.count; ++s) {
                ASSERT_LT(std::abs(part[Tap::v_out][s]), 10);  // NaN fails, too
            }
        }
        EXPECT_EQ(status, Status::unstable);
        EXPECT_EQ(part.count, 0U);
        EXPECT_NE(simulation.failure().find("stability limit"), std::string::npos);
        EXPECT_EQ(simulation.advance(part, 64), Status::unstable);
    }
}

TEST(Promises, SeriesShortenTheirPiecesWhereAStepWouldBeTooLong) {
    for (const Integrator integrator : {Integrator::taylor8, Integrator::taylor12}) {
        Simulation simulation(with_step(Scene{}, integrator, 5e-6), {});
        Samples part = simulation.make_samples(64);
        for (int i = 0; i < 100; ++i) {
            ASSERT_EQ(simulation.advance(part, 64), Status::running);
            for (std::size_t s = 0; s < part.count; ++s) {
                ASSERT_LT(std::abs(part[Tap::v_out][s]), 0.5);  // NaN fails, too; the peak is 0.355
            }
        }
    }
}

TEST(Promises, AStepBeyondTheStabilityLimitIsAFault) {
    Scene scene;
    const double limit = advise_step(scene).largest_stable_step_s;
    scene.numerics.step_s = 1.01 * limit;
    ASSERT_EQ(resolve(scene).faults.size(), 1U);
    EXPECT_EQ(resolve(scene).faults.front().key, "numerics.step_s");
    scene.numerics.step_s = 0.99 * limit;
    EXPECT_TRUE(resolve(scene).faults.empty());
}

TEST(Promises, AdviceDoesNotDependOnTheDuration) {
    Scene scene;
    const StepAdvice advice = advise_step(scene);
    scene.output.duration_s = 60;
    EXPECT_EQ(advise_step(scene).recommended_step_s, advice.recommended_step_s);
}

TEST(Promises, AnUndampedChainIsSaidToBeChaotic) {
    Scene scene;
    scene.chain.damping_kg_per_s = 0;
    const Resolution settled = resolve(scene);
    ASSERT_TRUE(settled.estimate.has_value());
    EXPECT_TRUE(settled.misses_accuracy());
    EXPECT_TRUE(settled.estimate->amplifies);
    EXPECT_FALSE(resolve(Scene{}).misses_accuracy());
    const Resolution given = resolve(settled.scene);  // with the step, as a file has it
    EXPECT_TRUE(given.step_set_by_scene);
    EXPECT_TRUE(given.misses_accuracy());
}

TEST(Promises, AGivenStepThatMissesTheMotionIsSaidSo) {
    Scene scene;
    scene.numerics.integrator = Integrator::leapfrog;
    const auto with_error = [&](double least, double most) {
        for (double step_s = 10e-9; step_s < 1e-6; step_s *= 1.2) {
            scene.numerics.step_s = step_s;
            const Resolution settled = resolve(scene);
            if (settled.faults.empty() && settled.estimate && settled.estimate->error > least &&
                settled.estimate->error < most) {
                return settled;
            }
        }
        ADD_FAILURE() << "no step has such an error";
        return resolve(scene);
    };
    EXPECT_FALSE(with_error(2e-4, 1e-2).misses_accuracy()) << "a given step asks for no accuracy";
    EXPECT_TRUE(with_error(0.06, 1).misses_accuracy());
    Scene longer = resolve(scene).scene;
    longer.numerics.step_s = 50e-9;
    longer.drive.repetition_hz = 1000;
    longer.output.duration_s = 0.05;
    EXPECT_TRUE(resolve(longer).may_miss_accuracy()) << "the estimate ends before the run";
}

TEST(Stability, TheLimitIsWhereALinearChainBlowsUp) {
    // contacts stay closed, overlaps near static: for a linear chain Gershgorin's bound is nearly exact
    Scene scene;
    scene.end.kind = EndKind::wall;
    scene.chain.damping_kg_per_s = 0;
    scene.drive.amplitude_m = 1e-12;
    scene.chain.spheres = 60;
    const Chain chain(scene);
    for (const Integrator integrator : choices<Integrator>) {
        const double limit = largest_stable_step(chain, chain.static_overlap, integrator);
        const auto energy_after = [&](double step) -> double {
            Scene stepped = with_step(scene, integrator, step);
            stepped.output.sample_rate_hz = 1 / step;
            // the horn - sphere contact is stiffer than the others and binds one mode: hence not exactly at the bound
            Simulation simulation(stepped);
            Samples part = simulation.make_samples(1000);
            for (int i = 0; i < 20; ++i) {
                if (simulation.advance(part, 1000) != Status::running) {
                    return std::numeric_limits<double>::infinity();
                }
            }
            return kinetic_energy(simulation.chain(), simulation.state());
        };
        EXPECT_LT(energy_after(0.97 * limit), 1e-16);
        if (integrator == Integrator::leapfrog || integrator == Integrator::chin4a) {
            EXPECT_GT(energy_after(1.25 * limit), 1e-10);
        } else {
            EXPECT_LT(energy_after(2 * limit), 1e-10);  // pieces are shortened before they blow up
        }
    }
}

}  // namespace
}  // namespace hertzline::test
