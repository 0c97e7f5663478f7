// Arrays of chains, against an independent solver, a second way of their own, and physical laws.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/array/array_solver.hpp"
#include "core/scene/elements.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "tests/support/modal_scenes.hpp"
#include "tests/support/records.hpp"
#include "tests/support/reference.hpp"

namespace hertzline::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr TapSet array_outputs =
    TapSet(Tap::v_last) | Tap::v_centre | Tap::v_face | Tap::p_axis | Tap::p_points;

/// Chains in a row along x, with few pieces.
Scene row_of_chains(std::size_t count, double pitch_m) {
    Scene scene = modal_scene();
    scene.drive.cycles = 4;
    scene.output.duration_s = 150e-6;
    scene.output.points_m = {{1e-3, 2e-3, 20e-3}};
    for (std::size_t i = 0; i < count; ++i) {
        scene.array.x_m.push_back(pitch_m * static_cast<double>(i));
        scene.array.y_m.push_back(0);
    }
    scene.numerics.integrator = Integrator::taylor8;
    scene.numerics.step_s = 0.5e-6;
    scene.numerics.poles = 36;
    return scene;
}

Samples samples_of(const Scene& scene, std::size_t threads = 1, std::size_t block = 0) {
    Simulation simulation(scene, {.taps = array_outputs, .threads = threads});
    const auto rows =
        static_cast<std::size_t>(std::lround(scene.output.duration_s * scene.output.sample_rate_hz)) + 1;
    Samples all = simulation.make_samples(rows);
    Samples part = simulation.make_samples(block > 0 ? block : rows);
    while (all.count < rows) {
        EXPECT_EQ(simulation.advance(part, std::min(part.capacity(), rows - all.count)), Status::running)
            << simulation.failure();
        for (const Tap tap : all.taps()) {
            std::ranges::copy(part[tap], all.room(tap).begin() +
                                             static_cast<std::ptrdiff_t>(all.count * all.channels(tap)));
        }
        all.count += part.count;
    }
    return all;
}

/// A channel of a tap, from 1 on.
std::vector<double> channel(const Samples& samples, Tap tap, std::size_t number, std::size_t each = 1) {
    std::vector<double> values;
    for (std::size_t i = number - 1; i < samples[tap].size(); i += each * samples.channels(tap)) {
        values.push_back(samples[tap][i]);
    }
    return values;
}

class EveryArrayReference : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Scenes, EveryArrayReference,
                         ::testing::Values("array_focus", "array_pair", "array_hexagon"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST_P(EveryArrayReference, TheEstimateTellsTheError) {
    const std::string file = GetParam();
    const Columns reference = read_columns(file, "array");
    for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
        Scene scene = read_scene(HERTZLINE_SOURCE_DIR "/tests/reference/array/" + file + ".toml");
        scene.numerics.accuracy = accuracy;
        const Resolution settled = resolve(scene);
        ASSERT_THAT(settled.faults, IsEmpty());
        scene = settled.scene;
        const Samples samples = samples_of(scene);
        double worst = 0;
        for (const auto& [name, expected] : reference) {
            const Tap tap = name.starts_with("p_")       ? Tap::p_points
                            : name.starts_with("v_last") ? Tap::v_last
                                                         : Tap::v_centre;
            if (name != "t_s") {
                const auto number = static_cast<std::size_t>(name[name.find_first_of("0123456789")] - '0');
                worst = std::max(worst, relative_l2(channel(samples, tap, number, 3), expected));
            }
        }
        // p_2 of array_focus is good to 6e-6: seven chains alone, at rates from 10 to 160 MHz, agree among each other to 1e-8
        const double of_reference = file == "array_focus" ? 6e-6 : 1e-8;
        EXPECT_LE(worst, accuracy + of_reference) << accuracy;
        EXPECT_LE(worst, 2 * settled.estimate->error + of_reference) << accuracy;
        EXPECT_FALSE(settled.misses_accuracy()) << settled.estimate->error;
    }
}

TEST(Array, WithoutCouplingIsTheSumOfItsChains) {
    Scene scene = row_of_chains(3, 11e-3);
    scene.array.coupling = Coupling::none;
    scene.array.delays_s = {0, 3.21e-6, 0};
    scene.array.preloads_n = {0.1, 0.1, 0.2};
    const Samples together = samples_of(scene);
    std::vector<double> sum(together.count);
    for (std::size_t i = 0; i < 3; ++i) {
        Scene one = element_scene(scene, i);
        one.output.points_m[0][0] -= scene.array.x_m[i];
        const Samples alone = samples_of(one);
        for (const Tap tap : {Tap::v_last, Tap::v_centre, Tap::v_face}) {
            const std::vector<double> of_element = channel(together, tap, i + 1);
            if (scene.array.delays_s[i] == 0) {
                EXPECT_EQ(of_element, channel(alone, tap, 1)) << row_of(tap).name << i;
            } else {  // as the first one, later, and not in pieces of its own
                EXPECT_LT(relative_l2(of_element, channel(alone, tap, 1)), 1e-8) << row_of(tap).name << i;
            }
        }
        for (std::size_t k = 0; k < sum.size(); ++k) {
            sum[k] += alone[Tap::p_points][k];
        }
    }
    EXPECT_LT(relative_l2(channel(together, Tap::p_points, 1), sum), 3e-6);
}

/// The numbers of the elements that each simulated chain stands for.
std::vector<std::vector<std::size_t>> elements_of_members(const Scene& scene) {
    std::vector<std::vector<std::size_t>> all;
    for (const ArrayMember& member : array_members(scene)) {
        std::vector<std::size_t>& elements = all.emplace_back();
        for (const auto& [number, delay_s] : member.elements) {
            EXPECT_DOUBLE_EQ(delay_s,
                             element_scene(scene, number).drive.start_s - member.scene.drive.start_s);
            elements.push_back(number);
        }
    }
    return all;
}

/// The force of a dashpot jumps when its contact closes or opens. Intervals of the force lie elsewhere at another sample rate.
TEST(Array, PressuresAfterAJumpOfTheForceDoNotDependOnWhereItsIntervalsLie) {
    Scene scene = read_scene(HERTZLINE_SOURCE_DIR "/tests/reference/array/array_focus.toml");
    scene.numerics.integrator = Integrator::taylor8;
    scene.numerics.step_s = 0.4e-6;
    for (const auto& [poles, error] : {std::pair{60, 3e-7}, {32, 1e-6}}) {
        scene.numerics.poles = poles;
        scene.output.sample_rate_hz = 10e6;
        const Samples expected = samples_of(scene);
        for (const std::size_t times : {2U, 7U}) {
            scene.output.sample_rate_hz = 10e6 * static_cast<double>(times);
            const Samples other = samples_of(scene);
            for (const std::size_t point : {1U, 2U}) {
                EXPECT_LT(relative_l2(channel(other, Tap::p_points, point, times),
                                      channel(expected, Tap::p_points, point)),
                          error)
                    << poles << ' ' << times << ' ' << point;
            }
        }
    }
}

TEST(Array, EqualChainsAreSimulatedOnce) {
    Scene scene = row_of_chains(5, 11e-3);
    scene.array.coupling = Coupling::none;
    scene.array.delays_s = {1e-6, 2e-6, 0, 1e-6, 0};
    EXPECT_THAT(elements_of_members(scene), ElementsAre(ElementsAre(2, 4, 0, 3, 1)));
    scene.array.preloads_n = {0.1, 0.2, 0.1, 0.2, 0.1};
    EXPECT_THAT(elements_of_members(scene), ElementsAre(ElementsAre(2, 4, 0), ElementsAre(3, 1)));
    scene.array.preloads_n.clear();
    scene.array.delays_s[1] = 1e-3;  // so late that its samples would have to wait in memory
    EXPECT_THAT(elements_of_members(scene), ElementsAre(ElementsAre(1), ElementsAre(2, 4, 0, 3)));
    scene.array.delays_s[1] = 2e-6;
    scene.chain.impact_velocity_m_per_s = 0.1;  // chains that move at once do not wait for their drives
    EXPECT_THAT(elements_of_members(scene),
                ElementsAre(ElementsAre(0, 3), ElementsAre(1), ElementsAre(2, 4)));
}

TEST(Array, ALaterChainHasAllOutputsOfOneThatIsSimulatedAlone) {
    Scene scene = row_of_chains(2, 11e-3);
    scene.array.coupling = Coupling::none;
    scene.drive.start_s = 0;
    scene.drive.horn = HornModel::resonator;
    scene.drive.horn_mass_kg = 1e-3;
    for (const bool resonator : {false, true}) {
        if (!resonator) {
            scene.drive.horn = HornModel::prescribed;
            scene.drive.horn_mass_kg = 0;
        }
        scene.array.delays_s = {0, 2.345e-6};
        constexpr TapSet taps = TapSet(Tap::v_out) | Tap::v_horn | Tap::x_horn | Tap::f_first | Tap::f_last;
        const auto run = [&](const Scene& of) {
            Simulation simulation(of, {.taps = taps});
            Samples samples = simulation.make_samples(1500);
            EXPECT_EQ(simulation.advance(samples, samples.capacity()), Status::running);
            const Ledger ledger = simulation.ledger();
            return std::pair{samples, std::array{ledger.work, ledger.lost, ledger.passed, ledger.radiated(),
                                                 ledger.at_start, simulation.energy_residual()}};
        };
        const auto [together, account] = run(scene);
        const auto [first, account_1] = run(element_scene(scene, 0));
        const auto [second, account_2] = run(element_scene(scene, 1));
        for (const Tap tap : taps) {
            EXPECT_EQ(channel(together, tap, 1), channel(first, tap, 1)) << row_of(tap).name;
            EXPECT_LT(relative_l2(channel(together, tap, 2), channel(second, tap, 1)), 1e-8)
                << row_of(tap).name;
            EXPECT_NEAR(together[tap][1], second[tap][0], 1e-12 * std::abs(second[tap][0]))
                << "at rest: " << row_of(tap).name;
        }
        for (std::size_t i = 0; i + 1 < account.size(); ++i) {
            EXPECT_NEAR(account[i], account_1[i] + account_2[i], 1e-3 * std::abs(account[i])) << i;
        }
        EXPECT_LT(account.back(), 1e-8);
    }
}

TEST(Array, ATapOfALaterChainThatIsAskedForLateIsMissingUntilItIsThere) {
    Scene scene = row_of_chains(2, 11e-3);
    scene.array.coupling = Coupling::none;
    scene.array.delays_s = {0, 3.05e-6};
    const Samples expected = samples_of(scene);
    Simulation simulation(scene, {.taps = array_outputs});
    Samples block = simulation.make_samples(20);
    const auto last = static_cast<std::size_t>(150e-6 * 10e6) / 20;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < last; ++i) {
        const TapSet wanted = i < 10 ? TapSet(Tap::v_last) : TapSet(Tap::v_last) | Tap::v_face;
        ASSERT_EQ(simulation.advance(block, 20, wanted), Status::running);
        EXPECT_TRUE(block.holds.contains(Tap::v_last));
        EXPECT_EQ(block.holds.contains(Tap::v_face), i >= 12) << i;  // 31 samples are ahead
        for (const Tap tap : block.holds) {
            for (std::size_t k = 0; k < 2 * block.count; ++k, ++seen) {
                ASSERT_EQ(block[tap][k], expected[tap][40 * i + k]) << row_of(tap).name << ' ' << i;
            }
        }
    }
    EXPECT_EQ(seen, 40 * (last + last - 12));
}

TEST(Array, GivesTheSameBitsWithAnyNumberOfThreadsAndInAnyBlocks) {
    const Scene scene = row_of_chains(3, 11.3e-3);
    const Samples expected = samples_of(scene);
    for (const auto& [threads, block] : {std::pair{2, 0}, {3, 7}, {1, 1}, {2, 300}}) {
        const Samples other =
            samples_of(scene, static_cast<std::size_t>(threads), static_cast<std::size_t>(block));
        for (const Tap tap : array_outputs) {
            EXPECT_TRUE(std::ranges::equal(other[tap], expected[tap]))
                << row_of(tap).name << threads << ' ' << block;
        }
    }
}

TEST(Array, ADiscWithoutADriveHearsTheOthers) {
    Scene scene = row_of_chains(3, 12e-3);
    scene.array.amplitudes_m = {3e-6, 0, 1e-12};
    const Samples samples = samples_of(scene);
    Simulation simulation(scene, {.taps = Tap::v_last});
    ASSERT_EQ(simulation.skip(1500), Status::running);
    EXPECT_LT(simulation.steps(), 10'000) << "pieces are as long as the sound of the others allows";
    const auto peak = [&](std::size_t element) {
        const std::vector<double> v = channel(samples, Tap::v_centre, element);
        return std::max(std::ranges::max(v), -std::ranges::min(v));
    };
    EXPECT_GT(peak(2), 0.05 * peak(1));
    EXPECT_LT(peak(2), peak(1));
    EXPECT_LT(peak(3), peak(2));
    EXPECT_GT(peak(3), 0);
}

/// Small discs that touch, at a rate at which samples and intervals have nothing in common.
TEST(Array, TheEstimateSeesTheIntervalsOfTheWater) {
    Scene scene = row_of_chains(3, 4e-3 * (1 + 1e-9));
    scene.end.radius_m = 2e-3;
    scene.output.sample_rate_hz = 7.46e6;
    scene.output.duration_s = 100e-6;
    scene.numerics = {};
    const Resolution settled = resolve(scene);
    ASSERT_THAT(settled.faults, IsEmpty());
    const Samples samples = samples_of(settled.scene);
    Scene fine = settled.scene;
    fine.numerics.step_s = 0.1e-6;
    const Samples truth = samples_of(fine);
    for (const Tap tap : array_outputs) {
        const double error = relative_l2(channel(samples, tap, 1), channel(truth, tap, 1));
        EXPECT_LE(error, 1e-4) << row_of(tap).name;
        EXPECT_LE(error, 2 * settled.estimate->error) << row_of(tap).name;
    }
}

// A sphere without losses between horn and plate: fits that are good to 1e-7 give motions that differ by 1e-3.
TEST(Array, TheEstimateSeesThatMotionsAmplifyTheErrorOfTheFit) {
    Scene scene = modal_scene();
    scene.drive.frequency_hz = 24.3e3;
    scene.drive.cycles = 8.57;
    scene.drive.amplitude_m = 1.1e-6;
    scene.drive.envelope = Envelope::tukey;
    scene.drive.taper = 0.17;
    scene.chain.material = "copper";
    scene.chain.spheres = 1;
    scene.chain.diameter_m = 0.558e-3;
    scene.chain.damping_kg_per_s = 0;
    scene.chain.preload_n = 0.176e-3;
    scene.end.material = "tungsten_carbide";
    scene.end.radius_m = 7.7e-3;
    scene.end.thickness_m = 0.106e-3;
    scene.end.modes = 5;
    scene.end.loss_factor = 0.0777;
    scene.array.x_m = {34.12e-3, 44.38e-3};
    scene.array.y_m = {30.66e-3, 17.13e-3};
    scene.array.delays_s = {1.94e-6, 1.74e-6};
    scene.output.hydrophone_m = 46.2e-3;
    scene.output.duration_s = 400e-6;
    scene.output.points_m = {{1e-3, 2e-3, 20e-3}};
    scene.numerics.integrator = Integrator::taylor12;
    scene.numerics.step_s = 0.2e-6;
    const auto with_poles = [&scene](std::int64_t poles) {
        scene.numerics.poles = poles;
        return channel(samples_of(scene), Tap::v_last, 2);
    };
    // fits of 58 to 62 poles are alike here, and so are those of 52, 54 and 64
    for (const std::int64_t poles : {60, 62, 64}) {
        const double difference = relative_l2(with_poles(poles == 64 ? 60 : 64), with_poles(poles));
        const Resolution settled = resolve(scene, scene.output.duration_s);
        ASSERT_THAT(settled.faults, IsEmpty());
        EXPECT_GE(settled.estimate->error, 0.9 * difference) << poles;
    }
}

TEST(Array, TheEstimateComparesMoreThanOneFitWhereNothingIsLost) {
    Scene scene = row_of_chains(2, 12e-3);
    scene.chain.damping_kg_per_s = 0;
    scene.array.delays_s = {0, 1e-6};
    scene.output.points_m = {{0, 0, 10e-3}, {5e-3, 0, 20e-3}};
    scene.output.duration_s = 300e-6;
    scene.numerics.integrator = Integrator::taylor12;
    scene.numerics.step_s = 0.2e-6;
    double largest = 0;
    const auto with_poles = [&scene](std::int64_t poles) {
        scene.numerics.poles = poles;
        return samples_of(scene);
    };
    const Samples other = with_poles(64);
    const Samples samples = with_poles(60);
    for (const std::size_t element : {1, 2}) {
        largest = std::max(largest, relative_l2(channel(samples, Tap::v_last, element),
                                                channel(other, Tap::v_last, element)));
    }
    const Resolution settled = resolve(scene, scene.output.duration_s);
    ASSERT_THAT(settled.faults, IsEmpty());
    EXPECT_GE(settled.estimate->error, 0.9 * largest);
    EXPECT_GT(largest, 1e-4);
}

TEST(Array, AFaultOfOneElementNamesIt) {
    Scene scene = row_of_chains(2, 12e-3);
    scene.numerics = {};
    scene.array.preloads_n = {0.1, 1e6};
    const Resolution settled = resolve(scene);
    ASSERT_FALSE(settled.faults.empty());
    EXPECT_THAT(settled.faults.front().message(), HasSubstr("of element 2 of the array"));
}

TEST(Array, EachRecordLiesWithinItsPeriod) {
    Scene scene = row_of_chains(2, 30e-3);
    scene.numerics = {};
    scene.drive = sampled(
        [](double t) { return 1e-6 * std::pow(std::sin(std::numbers::pi * std::min(t, 50e-6) / 50e-6), 4); },
        10e6, 60e-6);
    scene.drive.repetition_hz = 10e3;
    scene.array.delays_s = {0, 50e-6};
    const Resolution settled = resolve(scene);
    ASSERT_FALSE(settled.faults.empty());
    EXPECT_THAT(settled.faults.front().message(),
                AllOf(HasSubstr("array.delays_s: found 5e-05 s"), HasSubstr("lies within its period")));
}

TEST(Array, ALaterChainCountsTheEventsThatItHasHad) {
    Scene scene = row_of_chains(2, 30e-3);
    scene.array.coupling = Coupling::none;
    scene.array.delays_s = {0, 60e-6};
    scene.chain.preload_n = 0;
    const auto events = [](const Scene& of) {
        Simulation simulation(of, {.taps = Tap::v_last});
        EXPECT_EQ(simulation.skip(1000), Status::running);
        return simulation.contact_events();
    };
    const auto first = events(element_scene(scene, 0));
    const auto second = events(element_scene(scene, 1));
    EXPECT_GT(first, second + 5);
    EXPECT_NEAR(static_cast<double>(events(scene)), static_cast<double>(first + second), 2);
}

TEST(Array, StartsAgainAfterAReset) {
    const Scene scene = row_of_chains(2, 10.5e-3);
    Simulation simulation(scene, {.taps = array_outputs});
    Samples first = simulation.make_samples(700);
    Samples second = simulation.make_samples(700);
    ASSERT_EQ(simulation.advance(first, 700), Status::running);
    simulation.reset();
    ASSERT_EQ(simulation.advance(second, 700), Status::running);
    for (const Tap tap : array_outputs) {
        EXPECT_TRUE(std::ranges::equal(first[tap], second[tap])) << row_of(tap).name;
    }
}

TEST(Array, DiscsFarApartDoNotFeelEachOther) {
    Scene scene = row_of_chains(2, 1.0);  // sound takes 0.7 ms
    const Samples apart = samples_of(scene);
    scene.array.coupling = Coupling::none;
    const Samples alone = samples_of(scene);
    EXPECT_LT(relative_l2(channel(apart, Tap::v_centre, 1), channel(alone, Tap::v_centre, 1)), 1e-8);
    scene.array.coupling = Coupling::fluid;
    scene.array.x_m[1] = 12e-3;
    EXPECT_GT(relative_l2(channel(samples_of(scene), Tap::v_centre, 1), channel(alone, Tap::v_centre, 1)),
              0.05);
}

TEST(Array, DiscsThatTouchAreAsRightAsOthers) {
    Scene scene = row_of_chains(2, 10e-3);
    const Samples coarse = samples_of(scene);
    scene.numerics.step_s = 0.2e-6;
    const Samples fine = samples_of(scene);
    EXPECT_LT(relative_l2(channel(coarse, Tap::v_centre, 1), channel(fine, Tap::v_centre, 1)), 2e-5);
    EXPECT_LT(relative_l2(channel(coarse, Tap::p_points, 1), channel(fine, Tap::p_points, 1)), 2e-5);
}

TEST(Array, TheSampleRateChangesNoSample) {
    Scene scene = row_of_chains(2, 12e-3);
    const Samples at_10 = samples_of(scene);
    scene.output.sample_rate_hz = 100e6;
    const Samples at_100 = samples_of(scene);
    scene.output.sample_rate_hz = 2.5e6;
    const Samples at_2 = samples_of(scene);
    for (const Tap tap : array_outputs) {
        EXPECT_LT(relative_l2(channel(at_100, tap, 1, 10), channel(at_10, tap, 1)), 2e-5) << row_of(tap).name;
        EXPECT_LT(relative_l2(channel(at_10, tap, 1, 4), channel(at_2, tap, 1)), 2e-5) << row_of(tap).name;
    }
}

TEST(Array, ItsLedgerCloses) {
    Scene scene = row_of_chains(3, 11e-3);
    scene.output.duration_s = 300e-6;
    for (const Coupling coupling : {Coupling::fluid, Coupling::none}) {
        scene.array.coupling = coupling;
        Simulation simulation(scene, {.taps = Tap::v_last});
        ASSERT_EQ(simulation.skip(3000), Status::running);
        EXPECT_LT(simulation.energy_residual(), 1e-6);
        const Ledger ledger = simulation.ledger();
        EXPECT_GT(ledger.radiated(), 0.5 * ledger.passed);
        EXPECT_GT(ledger.plate_lost, 1e-3 * ledger.passed);
    }
}

TEST(Array, ItsWaterIsPassiveAndReciprocal) {
    Scene scene = row_of_chains(3, 10.2e-3);
    scene.array.preloads_n = {0.1, 0.1, 2};
    const ArraySolver solver(scene, {.taps = {}});
    const Water::Passivity passivity = solver.water()->passivity();
    EXPECT_GT(passivity.least_resistance, -1e-6);
    EXPECT_LT(passivity.asymmetry, 1e-6);
    EXPECT_THAT(array_warnings(scene), IsEmpty());
    scene.array.coupling = Coupling::none;
    EXPECT_THAT(array_warnings(scene), ElementsAre(HasSubstr("the discs do not feel each other")));
}

TEST(Array, ItsFocusIsWhereAllSoundsArriveTogether) {
    Scene scene = row_of_chains(4, 12e-3);
    scene.array.focus_m = {5e-3, 3e-3, 30e-3};
    const std::vector<double> delays = element_delays_s(scene);
    const double c = std::get<Fluid>(*find_material(scene, "water")).sound_speed_m_per_s;
    for (std::size_t i = 0; i < 4; ++i) {
        const double way = std::hypot(scene.array.x_m[i] - 5e-3, 3e-3, 30e-3);
        EXPECT_NEAR(delays[i] + way / c, delays[3] + std::hypot(31e-3, 3e-3, 30e-3) / c, 1e-15);
    }
    EXPECT_EQ(delays[3], 0);
    scene.array.delays_s = {1e-6};
    EXPECT_NEAR(element_delays_s(scene)[3], 1e-6, 1e-18);
}

/// Faults of a row of two chains that was changed.
std::string fault_after(void (*change)(Scene&)) {
    Scene scene = row_of_chains(2, 12e-3);
    change(scene);
    const std::vector<Fault> faults = validate(scene);
    return faults.empty() ? "" : faults.front().message();
}

TEST(Array, ElementsHaveTheirOwnDiameters) {
    Scene scene = row_of_chains(2, 12e-3);
    scene.array.coupling = Coupling::none;
    scene.array.diameters_m = {1e-3, 1.4e-3};
    const Samples together = samples_of(scene);
    scene.array.diameters_m.clear();
    for (std::size_t i = 0; i < 2; ++i) {
        Scene one = element_scene(scene, i);
        one.chain.diameter_m = i == 0 ? 1e-3 : 1.4e-3;
        EXPECT_EQ(channel(together, Tap::v_last, i + 1), channel(samples_of(one), Tap::v_last, 1)) << i;
    }
}

TEST(Array, WhatItCannotBeIsRefused) {
    EXPECT_EQ(fault_after([](Scene&) {}), "");
    EXPECT_THAT(fault_after([](Scene& s) { s.array.y_m.pop_back(); }),
                HasSubstr("array.y_m: found 1 entries with 2"));
    EXPECT_THAT(fault_after([](Scene& s) { s.array.x_m[1] = 9.9e-3; }), HasSubstr("elements 1 and 2"));
    EXPECT_THAT(fault_after([](Scene& s) {
                    s.array.preloads_n = {1, 2, 3};
                }),
                HasSubstr("array.preloads_n: found 3 entries"));
    EXPECT_THAT(fault_after([](Scene& s) { s.array.focus_m = {0, 0}; }), HasSubstr("array.focus_m"));
    EXPECT_THAT(fault_after([](Scene& s) { s.end.model = PlateModel::lumped; }), HasSubstr("end.model"));
    EXPECT_THAT(fault_after([](Scene& s) { s.medium.load = FluidLoad::none; }), HasSubstr("array.coupling"));
    EXPECT_THAT(fault_after([](Scene& s) { s.numerics.rest_tolerance = 1e-3; }),
                HasSubstr("numerics.rest_tolerance"));
    EXPECT_THAT(fault_after([](Scene& s) { s.drive.kind = DriveKind::live; }), HasSubstr("drive.kind"));
    EXPECT_THAT(fault_after([](Scene& s) {
                    s.array.delays_s = {0, 1e-3};
                    s.drive.repetition_hz = 1000;
                }),
                HasSubstr("a burst lies within its period"));
    EXPECT_THAT(fault_after([](Scene& s) {
                    s.chain.materials = {"steel"};
                    s.array.materials = {"steel"};
                }),
                HasSubstr("array.materials"));
    EXPECT_THAT(fault_after([](Scene& s) {
                    s.chain.diameters_m = {1e-3};
                    s.array.diameters_m = {1e-3};
                }),
                HasSubstr("array.diameters_m"));
    EXPECT_THAT(fault_after([](Scene& s) {
                    s.drive.kind = DriveKind::none;
                    s.array.delays_s = {0, 1e-6};
                }),
                HasSubstr("array.delays_s"));
    EXPECT_THAT(fault_after([](Scene& s) {
                    s.drive.kind = DriveKind::none;
                    s.array.amplitudes_m = {1e-6, 2e-6};
                }),
                HasSubstr("array.amplitudes_m"));
    for (auto change : {+[](Scene& s) {
                            s.array.delays_s = {1e-6, 2e-6, 3e-6};
                        },
                        +[](Scene& s) {
                            s.array.amplitudes_m = {1e-6, 2e-6, 3e-6};
                        },
                        +[](Scene& s) {
                            s.array.materials = {"steel", "steel", "steel"};
                        },
                        +[](Scene& s) {
                            s.array.diameters_m = {1e-3, 1e-3, 1e-3};
                        }}) {
        EXPECT_THAT(fault_after(change), HasSubstr("found 3 entries with 2 of array.x_m"));
    }
    EXPECT_THAT(
        fault_after([](Scene& s) { s.array.x_m.clear(), s.array.y_m.clear(), s.array.delays_s = {1}; }),
        HasSubstr("array.x_m: found nothing"));
}

}  // namespace
}  // namespace hertzline::test
