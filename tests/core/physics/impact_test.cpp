// Collisions of spheres against Hertz's theory and the conservation laws.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/model/contact_law.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"
#include "tests/support/bare_chain.hpp"
#include "tests/support/integrators.hpp"

namespace hertzline::test {
namespace {

constexpr double impact_speed = 0.5;  // [m/s]
constexpr double fine_step = 5e-9;    // an impact lasts about 3 us

class Impact : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, Impact, every_integrator, integrator_name);

/// Spheres that nothing holds together and that lose nothing.
Scene loose_spheres(Integrator integrator, std::int64_t spheres) {
    Scene scene = with_step(Scene{}, integrator, fine_step);
    scene.end.kind = EndKind::free;
    scene.chain.spheres = spheres;
    scene.chain.preload_n = 0;
    scene.chain.damping_kg_per_s = 0;
    return scene;
}

/// One sphere and a horn of constant speed: a sine so slow that its first microseconds are straight.
Scene struck_by_a_wall(Integrator integrator) {
    Scene scene = loose_spheres(integrator, 1);
    scene.drive.envelope = Envelope::rectangular;
    scene.drive.frequency_hz = 10;
    scene.drive.cycles = 1;
    scene.drive.amplitude_m = impact_speed / (2 * std::numbers::pi * scene.drive.frequency_hz);
    scene.output.sample_rate_hz = 1 / fine_step;
    return scene;
}

/// Returns the largest overlap [m] when a mass [kg] hits a contact of stiffness k [N/m^(3/2)] (Johnson 1985, eq. 11.2).
double largest_overlap(double mass, double k, double speed) {
    return std::pow(5 * mass * speed * speed / (4 * k), 0.4);
}

/// Returns the duration [s] of such an impact: 2 delta/u times the integral of 1/sqrt(1 - z^(5/2)), 0 to 1 (eq. 11.4).
double impact_duration(double mass, double k, double speed) {
    const double integral = std::sqrt(std::numbers::pi) * std::tgamma(0.4) / (2.5 * std::tgamma(0.9));
    return 2 * largest_overlap(mass, k, speed) / speed * integral;
}

/// One sphere flies into another that rests.
BareChain collided(Scene scene, std::int64_t steps) {
    BareChain pair(scene);
    pair.state.x.setConstant(1e-5);  // away from the horn
    pair.state.v[0] = impact_speed;
    pair.advance(steps);
    return pair;
}

TEST_P(Impact, SphereStruckByAWallLeavesTwiceAsFastAfterTheTimeThatHertzSays) {
    Simulation simulation(struck_by_a_wall(GetParam()));
    const double mass = 1 / simulation.chain().inv_mass[0];
    const double k = simulation.chain().stiffness[0];
    ASSERT_EQ(simulation.skip(2000), Status::running);
    const ChainState& state = simulation.state();
    const double t = simulation.time_s();
    EXPECT_NEAR(state.v[0] / impact_speed, 2, 2e-7);
    // from then on it gains on the wall by the impact speed
    const double left_at = t - (state.x[0] - impact_speed * t) / impact_speed;
    const double expected = impact_duration(mass, k, impact_speed);
    EXPECT_NEAR(left_at / expected, 1, 1e-5);
    EXPECT_NEAR(state.peak_overlap[0] / largest_overlap(mass, k, impact_speed), 1, 2e-5);
    // the form in which it is usually quoted, with E* of horn and sphere
    const Solid steel{201e9, 0.30, 7833};
    const Solid aluminium{69e9, 0.33, 2700};
    const double modulus = contact_modulus(steel, aluminium);
    const double quoted = 2.87 * std::pow(mass * mass / (0.5e-3 * modulus * modulus * impact_speed), 0.2);
    EXPECT_NEAR(left_at / quoted, 1, 2e-3);
    EXPECT_EQ(simulation.contact_events(), 2);
}

TEST_P(Impact, ASphereThrownAtAWallComesBackAsFastAsItWent) {
    Scene scene = loose_spheres(GetParam(), 1);
    scene.end.kind = EndKind::wall;
    scene.drive.kind = DriveKind::none;
    scene.output.sample_rate_hz = 1 / fine_step;
    for (const double speed : {0.01, 1.0}) {
        scene.chain.impact_velocity_m_per_s = speed;
        Simulation simulation(scene);
        const double mass = 1 / simulation.chain().inv_mass[0];
        const double k = simulation.chain().stiffness[1];
        const double expected = impact_duration(mass, k, speed);
        ASSERT_EQ(simulation.skip(std::llround(1.5 * expected / fine_step)), Status::running);
        EXPECT_NEAR(simulation.state().v[0] / speed, -1, 2e-7);
        const double left_at = simulation.time_s() + simulation.state().x[0] / speed;
        EXPECT_NEAR(left_at / expected, 1, 1e-5);
        EXPECT_EQ(simulation.contact_events(), 2);
        EXPECT_NEAR(simulation.state().peak_overlap[1] / largest_overlap(mass, k, speed), 1, 1e-4);
    }
}

/// The pieces of a step that the program chooses are long: the largest overlap lies within one of them.
TEST(SeriesPieces, ShowTheLargestOverlapOfAnImpactWherePiecesAreLong) {
    for (const double accuracy : {1e-3, 1e-4}) {
        for (const double speed : {0.01, 0.1, 1.0}) {
            Scene scene;
            scene.chain.spheres = 1;
            scene.chain.preload_n = 0;
            scene.chain.damping_kg_per_s = 0;
            scene.chain.impact_velocity_m_per_s = speed;
            scene.end.kind = EndKind::wall;
            scene.drive.kind = DriveKind::none;
            scene.numerics.accuracy = accuracy;
            Simulation simulation(resolve(scene));
            EXPECT_EQ(simulation.skip(
                          static_cast<std::int64_t>(scene.output.duration_s * scene.output.sample_rate_hz)),
                      Status::running);
            const double mass = 1 / simulation.chain().inv_mass[0];
            const double expected = largest_overlap(mass, simulation.chain().stiffness[1], speed);
            EXPECT_NEAR(simulation.state().peak_overlap[1] / expected, 1, 3 * accuracy)
                << accuracy << ' ' << speed;
        }
    }
}

TEST(SeriesPieces, ShowTheLargestForceBetweenUnequalSpheres) {
    for (const double accuracy : {1e-2, 1e-3, 1e-4, 1e-6}) {
        for (const double speed : {0.3, 1.0, 2.0}) {
            Scene scene;
            scene.drive.kind = DriveKind::none;
            scene.chain.spheres = 2;
            scene.chain.materials = {"tungsten_carbide", "ptfe"};
            scene.chain.diameters_m = {4e-3, 1e-3};
            scene.chain.preload_n = 0;
            scene.chain.damping_kg_per_s = 0;
            scene.chain.impact_velocity_m_per_s = speed;
            scene.end.kind = EndKind::free;
            scene.numerics.accuracy = accuracy;
            Simulation simulation(resolve(scene));
            EXPECT_EQ(simulation.skip(1000), Status::running);
            const Eigen::ArrayXd& inv_mass = simulation.chain().inv_mass;
            const double expected =
                largest_overlap(1 / (inv_mass[0] + inv_mass[1]), simulation.chain().stiffness[1], speed);
            EXPECT_NEAR(simulation.state().peak_overlap[1] / expected, 1, 3 * accuracy)
                << accuracy << ' ' << speed;
        }
    }
}

TEST_P(Impact, TwoEqualSpheresExchangeTheirVelocitiesInTheTimeThatHertzSays) {
    const BareChain pair = collided(loose_spheres(GetParam(), 2), 2000);
    const double reduced_mass = 0.5 / pair.chain.inv_mass[0];
    EXPECT_NEAR(pair.state.v[0] / impact_speed, 0, 2e-8);
    EXPECT_NEAR(pair.state.v[1] / impact_speed, 1, 2e-8);
    const double parted_at = pair.time_s() - (pair.state.x[1] - pair.state.x[0]) / impact_speed;
    const double expected = impact_duration(reduced_mass, pair.chain.stiffness[1], impact_speed);
    EXPECT_NEAR(parted_at / expected, 1, 1e-5);
}

TEST_P(Impact, ImpactsLastLongerBySpeedToTheMinusOneFifth) {
    const auto duration = [&](double speed) {
        Scene scene = struck_by_a_wall(GetParam());
        scene.drive.amplitude_m *= speed / impact_speed;
        Simulation simulation(scene);
        EXPECT_EQ(simulation.skip(4000), Status::running);
        return 2 * simulation.time_s() - simulation.state().x[0] / speed;
    };
    EXPECT_NEAR(std::log2(duration(0.25) / duration(0.5)), 0.2, 1e-5);
    EXPECT_NEAR(std::log2(duration(0.125) / duration(0.25)), 0.2, 1e-5);
}

TEST_P(Impact, DashpotsKeepMomentumAndBookWhatTheyTakeFromTheEnergy) {
    Scene scene = loose_spheres(GetParam(), 2);
    scene.chain.damping_kg_per_s = 0.1;
    const BareChain pair = collided(scene, 2000);
    const double mass = 1 / pair.chain.inv_mass[0];
    EXPECT_NEAR((pair.state.v[0] + pair.state.v[1]) / impact_speed, 1, 1e-13);
    EXPECT_LT(pair.state.v[1] - pair.state.v[0], 0.9 * impact_speed);
    const double at_first = 0.5 * mass * impact_speed * impact_speed;
    EXPECT_NEAR((kinetic_energy(pair.chain, pair.state) + pair.lost) / at_first, 1, 5e-6);
}

TEST_P(Impact, AChainOfCollisionsKeepsMomentumAndEnergy) {
    BareChain chain = collided(loose_spheres(GetParam(), 8), 0);
    const double before = chain.energy();
    chain.advance(8000);
    EXPECT_NEAR(chain.state.v.head(8).sum() / impact_speed, 1, 1e-13);
    EXPECT_NEAR(chain.energy() / before, 1, 5e-8);
    EXPECT_GT(chain.state.v[7], 0.95 * impact_speed);  // nearly all arrives at the far end
}

/// Returns the velocities of a single sphere while a wall strikes it.
std::vector<double> rebounds(Integrator integrator, Tension tension) {
    Scene scene = struck_by_a_wall(integrator);
    scene.chain.damping_kg_per_s = 0.3;
    scene.chain.tension = tension;
    return recorded(scene, 2000).v_last;
}

TEST_P(Impact, AClampedContactNeverPullsAndAnUnclampedOneDoesBeforeItOpens) {
    const std::vector<double> clamped = rebounds(GetParam(), Tension::clamped);
    const std::vector<double> allowed = rebounds(GetParam(), Tension::allowed);
    EXPECT_TRUE(std::is_sorted(clamped.begin(), clamped.end()));
    EXPECT_FALSE(std::is_sorted(allowed.begin(), allowed.end()));
    EXPECT_GT(clamped.back(), allowed.back() + 0.01 * impact_speed);
    EXPECT_NEAR(clamped.back() / *std::max_element(allowed.begin(), allowed.end()), 1, 1e-5);
}

TEST_P(Impact, ASphereThatComesBackBouncesOffTheRestingHornAsHertzSays) {
    // One undamped sphere on the horn, with nothing behind it but a small constant force: a burst throws it
    // off, the force brings it back, and it bounces off the resting horn. Duration 2.943 delta_max / v
    // (Johnson 1985, eq. 11.24), with m v^2/2 = (2/5) k delta_max^(5/2).
    Scene scene;
    scene.chain.spheres = 1;
    scene.chain.damping_kg_per_s = 0;
    scene.chain.preload_n = 1e-3;
    scene.end.kind = EndKind::free;
    scene.drive.cycles = 1;
    scene.drive.frequency_hz = 20e3;
    scene.output.sample_rate_hz = 100e6;
    const Record record = recorded(with_step(scene, GetParam(), 10e-9), 200'000, 1024);
    const Chain chain(scene);
    const auto overlap = [&](std::size_t i) { return chain.static_overlap[0] - record.chain_x[i]; };
    std::size_t touch = 10'000;  // 0.1 ms: the horn rests and the sphere is on its way
    ASSERT_LT(overlap(touch), 0);
    while (touch < 200'000 && overlap(touch) <= 0) {
        ++touch;
    }
    ASSERT_LT(touch, 190'000U);
    std::size_t apart = touch;
    while (apart < 199'999 && overlap(apart) > 0) {
        ++apart;
    }
    const double speed = -record.v_last[touch];
    const double depth = std::pow(1.25 * speed * speed / (chain.inv_mass[0] * chain.stiffness[0]), 0.4);
    EXPECT_GT(speed, 0.01);
    EXPECT_NEAR(static_cast<double>(apart - touch) * 10e-9 / (2.943 * depth / speed), 1, 0.01);
    EXPECT_NEAR(record.v_last[apart] / speed, 1, 1e-3);  // elastic: as fast as it came
}

}  // namespace
}  // namespace hertzline::test
