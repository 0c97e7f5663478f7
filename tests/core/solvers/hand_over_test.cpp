// A chain whose drive changes: its motion continues.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/model/bursts.hpp"
#include "core/model/horn.hpp"
#include "hertzline/simulation.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/records.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/seen_scenes.hpp"

namespace hertzline::test {
namespace {

constexpr std::int64_t change = 20000;  // a burst's start, 2 ms
constexpr std::int64_t end = 26000;

/// The tone of a scene as a record, repeated as its bursts.
Scene recorded_bursts(Scene scene) {
    const Drive tone = scene.drive;
    const double rate = 20e6;
    const auto horn = make_horn(tone, 1 / rate);
    scene.drive =
        sampled([&](double t) { return horn->at(static_cast<std::int64_t>(std::llround(t * rate)), 0).x; },
                rate, tone.cycles / tone.frequency_hz);
    scene.drive.repetition_hz = tone.repetition_hz;
    scene.drive.frequency_hz = tone.frequency_hz;
    return scene;
}

/// Returns a scene whose bursts find the chain still ringing.
Scene ringing() {
    Scene scene = growing_scene();
    scene.output.hydrophone_m = 3e-3;
    return scene;
}

struct Case {
    std::string name;
    Scene scene;  ///< its step is chosen in the test: every start of this program lists the cases
};

std::vector<Case> cases() {
    Scene modal = ringing();
    modal.end.model = PlateModel::modal;
    modal.end.material = "vitreous_carbon";
    Scene laws = ringing();
    laws.chain.damping_law = DampingLaw::tsuji;
    laws.chain.damping_alpha = 0.1;
    Scene loose = ringing();
    loose.chain.preload_n = 0;
    loose.drive.envelope = Envelope::rectangular;
    Scene resonator = ringing();
    resonator.drive.horn = HornModel::resonator;
    resonator.drive.horn_quality = 40;
    resonator.drive.horn_mass_kg = 1e-4;
    return {{"plate", ringing()},
            {"resonator", resonator},
            {"record", recorded_bursts(ringing())},
            {"modal", modal},
            {"tsuji", laws},
            {"loose", loose},
            {"leapfrog", with_step(ringing(), Integrator::leapfrog, 1e-8)},
            {"chin4a", with_step(ringing(), Integrator::chin4a, 2e-8)}};
}

std::vector<double> column(Simulation& simulation, Tap tap, std::int64_t until) {
    Samples block = simulation.make_samples(700);
    std::vector<double> values;
    while (simulation.next_sample() < until) {
        EXPECT_EQ(simulation.advance(block, static_cast<std::size_t>(std::min<std::int64_t>(
                                                700, until - simulation.next_sample()))),
                  Status::running);
        values.insert(values.end(), block[tap].begin(), block[tap].end());
    }
    return values;
}

class HandOver : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Of, HandOver, testing::ValuesIn(cases()),
                         [](const auto& one) { return one.param.name; });

TEST_P(HandOver, ToTheSameDriveChangesNothing) {
    const Scene scene = settled(GetParam().scene);
    const SimulationOptions options{.taps = everything};
    for (const Tap tap : taps_of(scene) - Tap::v_chain - Tap::x_chain) {
        Simulation whole(scene, options);
        const std::vector<double> expected = column(whole, tap, end);
        Simulation first(scene, options);
        Simulation second(scene, options);
        first.end_at(change);
        std::vector<double> found = column(first, tap, change);
        ASSERT_EQ(second.continue_from(first, change), Status::running);
        EXPECT_EQ(second.next_sample(), change);
        const std::vector<double> rest = column(second, tap, end);
        found.insert(found.end(), rest.begin(), rest.end());
        double largest = 0;
        double apart = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            largest = std::max(largest, std::abs(expected[i]));
            apart = std::max(apart, std::abs(found[i] - expected[i]));
        }
        // a series has other pieces from there on, and errors grow in a chain that rings
        EXPECT_LT(apart, 1e-4 * largest) << row_of(tap).name;
        EXPECT_NEAR(second.energy_residual(), whole.energy_residual(), 1e-4) << row_of(tap).name;
    }
}

TEST_P(HandOver, ToAnotherDriveMovesOnWithoutAJumpOrAnAllocation) {
    const Scene scene = settled(GetParam().scene);
    Scene stronger = scene;
    stronger.drive.amplitude_m *= 1.5;
    stronger.drive.frequency_hz = 60e3;
    stronger.numerics.step_s = *stronger.numerics.step_s / 2;
    Simulation first(scene, {.taps = everything});
    Simulation second(stronger, {.taps = everything});
    first.end_at(change);
    Samples block = second.make_samples(1);
    std::vector<double> before = column(first, Tap::v_last, change);
    const std::size_t allocated = allocations();
    ASSERT_EQ(second.continue_from(first, change), Status::running);
    ASSERT_EQ(second.advance(block, 1), Status::running);
    EXPECT_EQ(allocations(), allocated);
    EXPECT_EQ(block.first, change);
    const auto of = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const double largest = std::abs(*std::ranges::max_element(before, of));
    EXPECT_NEAR(block[Tap::v_last][0], 2 * before.back() - before[before.size() - 2], 0.01 * largest);
    column(second, Tap::v_last, end);
    EXPECT_LT(second.energy_residual(), 1e-3);
}

TEST(HandOver, IsTheSameWhereverTheEndBecomesKnown) {
    const Scene scene = settled(ringing());
    Simulation early(scene, {.taps = everything});
    Simulation late(scene, {.taps = everything});
    Simulation after_early(scene, {.taps = everything});
    Simulation after_late(scene, {.taps = everything});
    early.end_at(change + 7);
    column(early, Tap::v_out, change + 7);
    column(late, Tap::v_out, change - 100);
    ASSERT_LE(late.first_open_sample(), change + 7);
    late.end_at(change + 7);
    column(late, Tap::v_out, change + 7);
    ASSERT_EQ(after_early.continue_from(early, change + 7), Status::running);
    ASSERT_EQ(after_late.continue_from(late, change + 7), Status::running);
    EXPECT_EQ(column(after_early, Tap::v_out, end), column(after_late, Tap::v_out, end));
}

TEST(HandOver, OfAGridNeedsStepsThatDivideTheSamplePeriod) {
    EXPECT_TRUE(Simulation::can_hand_over(with_step(ringing(), Integrator::leapfrog, 1e-8)));
    EXPECT_FALSE(Simulation::can_hand_over(with_step(ringing(), Integrator::leapfrog, 0.9e-8)));
}

TEST(HandOver, NeedsTheSameTaps) {
    const Scene scene = with_step(ringing(), Integrator::taylor8, 700e-9);
    Simulation before(scene, {.taps = Tap::v_out});
    Simulation after(scene, {.taps = TapSet(Tap::v_out) | Tap::v_last});
    before.end_at(change);
    column(before, Tap::v_out, change);
    EXPECT_EQ(after.continue_from(before, change), Status::unstable);
    EXPECT_NE(after.failure().find("other taps"), std::string::npos);
    after.reset();
    EXPECT_EQ(after.failure(), "");
    EXPECT_EQ(after.skip(100), Status::running);
}

TEST(HandOver, BurstsStartAtASampleOrJustBehindOne) {
    const Bursts thirds(10, 3);
    EXPECT_EQ(thirds.last_sample_until(1), 3);
    EXPECT_EQ(thirds.first_sample(1), 4);
    EXPECT_EQ(thirds.last_sample_until(3), 10);
}

}  // namespace
}  // namespace hertzline::test
