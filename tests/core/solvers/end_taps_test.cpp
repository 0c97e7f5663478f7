// The taps that follow from the motion at the chain's far end, against the equations of docs/model.md, for every integrator.

#include "core/solvers/sampling/end_taps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "core/model/contact_law.hpp"
#include "tests/support/ends.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

class EndTapsOf : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, EndTapsOf, every_integrator, integrator_name);

Scene with_end(EndKind kind) {
    Scene scene;
    scene.end.kind = kind;
    return scene;
}

TEST(EndTaps, OutputIsWhatTheOpenOrClosedContactTransmitsAndThePlatesVelocity) {
    Simulation simulation(with_step(Scene{}, Integrator::chin4a, 25e-9), {.taps = everything});
    Samples sample = simulation.make_samples(1);
    const Chain& chain = simulation.chain();
    const Eigen::Index n = chain.spheres();
    int opened = 0;
    for (int k = 0; k < 3000; ++k) {
        ASSERT_EQ(simulation.advance(sample, 1), Status::running);
        const ChainState& state = simulation.state();
        const bool closed = chain.static_overlap[n] + (state.x[n - 1] - state.x[n]) > 0;
        const double expected = (closed ? chain.end.transmission * state.v[n - 1] : 0) + state.v[n];
        ASSERT_NEAR(sample[Tap::v_out][0], expected, 1e-12) << k;
        opened += closed ? 0 : 1;
    }
    EXPECT_GT(opened, 100) << "the test must see both";
}

TEST_P(EndTapsOf, AWallAndAFreeEndGiveTheLastSpheresVelocity) {
    for (const EndKind kind : {EndKind::wall, EndKind::free}) {
        const Record record = recorded(with_step(with_end(kind), GetParam(), 50e-9), 2000);
        EXPECT_EQ(record.v_out, record.v_last);
        EXPECT_TRUE(record.v_plate.empty());
    }
}

TEST_P(EndTapsOf, TheLastSphereIsTheLastOfTheChain) {
    const Record record = recorded(with_step(Scene{}, GetParam(), 50e-9), 2000);
    for (std::size_t k = 0; k < record.v_last.size(); ++k) {
        ASSERT_EQ(record.v_last[k], record.chain_v[6 * k + 5]) << k;
    }
}

/// Returns the derivative of A e(t) sin(2 pi f t) (docs/model.md, section 5), t since the burst's start.
double burst_velocity(const Drive& drive, double t) {
    const double duration = drive.cycles / drive.frequency_hz;
    if (t < 0 || t >= duration) {
        return 0;
    }
    const double pi = std::numbers::pi;
    double e = 1;
    double slope = 0;
    const double ramp = drive.envelope == Envelope::hann    ? duration / 2
                        : drive.envelope == Envelope::tukey ? drive.taper * duration / 2
                                                            : 0;
    const double from_edge = std::min(t, duration - t);
    if (from_edge < ramp) {
        e = (1 - std::cos(pi * from_edge / ramp)) / 2;
        slope = (t < duration / 2 ? 1 : -1) * pi / (2 * ramp) * std::sin(pi * from_edge / ramp);
    }
    const double omega = 2 * pi * drive.frequency_hz;
    return drive.amplitude_m * (slope * std::sin(omega * t) + e * omega * std::cos(omega * t));
}

TEST_P(EndTapsOf, TheHornsVelocityIsTheDerivativeOfTheBurst) {
    for (const Envelope envelope : choices<Envelope>) {
        Scene scene = with_step(Scene{}, GetParam(), 50e-9);
        scene.drive.envelope = envelope;
        scene.drive.cycles = 7.3;
        scene.drive.taper = 0.4;
        scene.drive.repetition_hz = 7e3;
        Simulation simulation(scene, {.taps = TapSet(Tap::v_horn)});
        Samples samples = simulation.make_samples(3000);
        ASSERT_EQ(simulation.advance(samples, 3000), Status::running);
        for (std::size_t k = 0; k < samples.count; ++k) {
            const double t = static_cast<double>(k) / scene.output.sample_rate_hz;
            const double since_burst =
                t - std::floor(t * scene.drive.repetition_hz) / scene.drive.repetition_hz;
            ASSERT_NEAR(samples[Tap::v_horn][k], burst_velocity(scene.drive, since_burst), 1e-9)
                << word(envelope) << ", sample " << k;
        }
    }
}

TEST_P(EndTapsOf, TheHornsVelocityDoesNotDependOnHowSamplesAreCutIntoBlocks) {
    const Scene scene = with_step(Scene{}, GetParam(), 50e-9);
    Simulation whole(scene, {.taps = TapSet(Tap::v_horn)});
    Samples all = whole.make_samples(2000);
    ASSERT_EQ(whole.advance(all, 2000), Status::running);
    Simulation cut(scene, {.taps = TapSet(Tap::v_horn)});
    Samples part = cut.make_samples(37);
    for (std::size_t done = 0; done + 37 <= 2000; done += 37) {
        ASSERT_EQ(cut.advance(part, 37), Status::running);
        ASSERT_TRUE(std::ranges::equal(part[Tap::v_horn], all[Tap::v_horn].subspan(done, 37))) << done;
    }
}

TEST(EndTaps, TheLastContactsForceIsHertzsLawAndTheDashpot) {
    for (const EndKind kind : {EndKind::plate, EndKind::wall}) {
        Simulation simulation(with_step(with_end(kind), Integrator::chin4a, 25e-9),
                              {.taps = TapSet(Tap::f_last)});
        Samples sample = simulation.make_samples(1);
        const Chain& chain = simulation.chain();
        const Eigen::Index n = chain.spheres();
        double lowest = 0;
        for (int k = 0; k < 3000; ++k) {
            ASSERT_EQ(simulation.advance(sample, 1), Status::running);
            const ChainState& state = simulation.state();
            const double overlap = chain.static_overlap[n] + (state.x[n - 1] - state.x[n]);
            const double force = overlap > 0 ? chain.stiffness[n] * std::pow(overlap, 1.5) +
                                                   chain.damping[n] * (state.v[n - 1] - state.v[n])
                                             : 0;
            ASSERT_NEAR(sample[Tap::f_last][0], force, 1e-9 + 1e-9 * std::abs(force)) << k;
            ASSERT_TRUE(k > 0 || std::abs(force - chain.preload_n) < 1e-12) << "at rest it is the preload";
            lowest = std::min(lowest, force);
        }
        EXPECT_LT(lowest, -1e-3) << "as printed, the law pulls before a contact opens";
    }
}

// Newton's law for each sphere: the impulse of its two contacts is its momentum.
TEST_P(EndTapsOf, TheForcesOfItsContactsMoveEachSphere) {
    for (const EndKind kind : {EndKind::plate, EndKind::free}) {
        Scene scene = with_end(kind);
        scene.output.sample_rate_hz = 200e6;
        scene = with_step(scene, GetParam(), 5e-9);
        Simulation simulation(scene, {.taps = TapSet(Tap::f_chain) | Tap::v_chain});
        const Chain& chain = simulation.chain();
        const auto spheres = static_cast<std::size_t>(chain.spheres());
        const std::size_t contacts = spheres + 1;
        Samples samples = simulation.make_samples(20'000);
        ASSERT_EQ(simulation.advance(samples, 20'000), Status::running);
        const auto v = samples[Tap::v_chain];
        const auto f = samples[Tap::f_chain];
        ASSERT_EQ(f.size(), samples.count * contacts);
        for (std::size_t s = 0; s < spheres; ++s) {
            const double mass = 1 / chain.inv_mass[static_cast<Eigen::Index>(s)];
            double impulse = 0;  // by the trapezoidal rule
            double largest_error = 0;
            double largest_momentum = 0;
            const auto push = [&](std::size_t k) { return f[k * contacts + s] - f[k * contacts + s + 1]; };
            for (std::size_t k = 1; k < samples.count; ++k) {
                impulse += (push(k - 1) + push(k)) / 2 / scene.output.sample_rate_hz;
                const double momentum = mass * v[k * spheres + s];
                largest_error = std::max(largest_error, std::abs(momentum - impulse));
                largest_momentum = std::max(largest_momentum, std::abs(momentum));
            }
            EXPECT_LT(largest_error, 2e-3 * largest_momentum) << "sphere " << s;
        }
    }
}

TEST_P(EndTapsOf, TheLastOfAllContactsIsThatOfTheEnd) {
    const TapSet taps = TapSet(Tap::f_chain) | Tap::f_last;
    for (const EndKind kind : {EndKind::plate, EndKind::wall, EndKind::free}) {
        const Scene scene = with_step(with_end(kind), GetParam(), 10e-9);
        Simulation simulation(scene, {.taps = taps & taps_of(scene)});
        const auto contacts = static_cast<std::size_t>(simulation.chain().bodies());
        Samples samples = simulation.make_samples(3000);
        ASSERT_EQ(simulation.advance(samples, 3000), Status::running);
        for (std::size_t k = 0; k < samples.count; ++k) {
            const double expected = kind == EndKind::free ? scene.chain.preload_n : samples[Tap::f_last][k];
            ASSERT_EQ(samples[Tap::f_chain][(k + 1) * contacts - 1], expected) << k;
        }
    }
}

// Newton's law for the plate: plate, spring and preload take up the impulse of the last contact.
TEST_P(EndTapsOf, TheLastContactsForceMovesThePlate) {
    Scene scene;
    scene.output.sample_rate_hz = 200e6;
    scene = with_step(scene, GetParam(), 5e-9);
    const TapSet taps = TapSet(Tap::f_last) | Tap::v_plate;
    Simulation simulation(scene, {.taps = taps});
    const Chain& chain = simulation.chain();
    const double mass = 1 / chain.inv_mass[chain.spheres()];
    const double spring = chain.spring[chain.spheres()];
    const double dt = 1 / scene.output.sample_rate_hz;
    Samples samples = simulation.make_samples(40'000);
    ASSERT_EQ(simulation.advance(samples, 40'000), Status::running);
    const auto v = samples[Tap::v_plate];
    const auto f = samples[Tap::f_last];
    double x = 0;
    double impulse = 0;  // of the forces on the plate, by the trapezoidal rule
    double largest_error = 0;
    double largest_momentum = 0;
    for (std::size_t k = 1; k < samples.count; ++k) {
        const double x_before = x;
        x += dt * (v[k - 1] + v[k]) / 2;
        impulse += dt * ((f[k - 1] + f[k]) / 2 - chain.preload_n - spring * (x_before + x) / 2);
        largest_error = std::max(largest_error, std::abs(mass * v[k] - impulse));
        largest_momentum = std::max(largest_momentum, std::abs(mass * v[k]));
    }
    EXPECT_LT(largest_error, 2e-3 * largest_momentum);
}

TEST_P(EndTapsOf, WithoutTensionTheLastContactNeverPulls) {
    Scene scene = with_step(Scene{}, GetParam(), 50e-9);
    scene.chain.tension = Tension::clamped;
    Simulation simulation(scene, {.taps = TapSet(Tap::f_last)});
    Samples samples = simulation.make_samples(3000);
    ASSERT_EQ(simulation.advance(samples, 3000), Status::running);
    EXPECT_GE(*std::ranges::min_element(samples[Tap::f_last]), 0);
    EXPECT_GT(*std::ranges::max_element(samples[Tap::f_last]), 1);
}

TEST(EndTaps, AFreeEndHasNoLastContact) {
    EXPECT_FALSE(taps_of(scene_with_end(EndKind::free)).contains(Tap::f_last));
    EXPECT_TRUE(taps_of(scene_with_end(EndKind::wall)).contains(Tap::f_last));
    Simulation simulation(with_step(with_end(EndKind::free), Integrator::taylor8, 900e-9),
                          {.taps = everything});
    EXPECT_FALSE(simulation.taps().contains(Tap::f_last));
}

}  // namespace
}  // namespace hertzline::test
