// Small signals in a preloaded chain: static equilibrium, dispersion, wave speed.

#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "core/model/contact_law.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

constexpr std::size_t spheres = 400;
constexpr std::size_t near = 60;  // sphere from which a wave is watched ...
constexpr std::size_t far = 120;  // ... to this one, long before the far end answers

/// Returns a long undamped chain, pressed so hard and driven so little that it is linear.
Scene linear_chain(Integrator integrator, double frequency_hz) {
    Scene scene = with_step(Scene{}, integrator, 25e-9);
    scene.end.kind = EndKind::wall;
    scene.chain.spheres = spheres;
    scene.chain.damping_kg_per_s = 0;
    scene.chain.preload_n = 10;
    scene.drive.amplitude_m = 1e-11;
    scene.drive.cycles = 5;
    scene.drive.frequency_hz = frequency_hz;
    return scene;
}

/// Returns a sphere's velocity at one frequency: the Fourier sum over the whole record.
std::complex<double> component(const Record& record, std::size_t sphere, double frequency_hz) {
    const std::size_t samples = record.chain_v.size() / spheres;
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < samples; ++i) {
        const double turn = 2 * std::numbers::pi * frequency_hz * static_cast<double>(i) / 1e7;
        sum += record.chain_v[i * spheres + sphere] * std::polar(1.0, -turn);
    }
    return sum;
}

/// Returns the phase [rad] by which the motion of a frequency lags from sphere `near` to sphere `far`, up to whole turns.
double phase_lag(const Scene& scene) {
    const double frequency = scene.drive.frequency_hz;
    const Record record = recorded(scene, static_cast<std::size_t>((200e-6 + 5 / frequency) * 1e7));
    return std::arg(component(record, near, frequency) / component(record, far, frequency));
}

/// Returns sqrt(k_t/m) [rad/s] of the spheres' contacts at static overlap.
double chain_frequency(const Scene& scene) {
    const Chain chain(scene);
    return std::sqrt(tangent_stiffness(chain.stiffness[1], chain.static_overlap[1]) * chain.inv_mass[0]);
}

class Wave : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, Wave, every_integrator, integrator_name);

TEST_P(Wave, PhaseFollowsTheDispersionOfALinearChain) {
    const double bound = GetParam() == Integrator::leapfrog ? 1e-2 : 1e-4;  // [rad]
    for (const double frequency : {73e3, 150e3}) {
        const Scene scene = linear_chain(GetParam(), frequency);
        // omega = 2 sqrt(k_t/m) sin(q/2), q the phase per sphere (Kittel, Solid State Physics, chapter 4)
        const double per_sphere = 2 * std::asin(std::numbers::pi * frequency / chain_frequency(scene));
        const double expected = per_sphere * static_cast<double>(far - near);
        EXPECT_NEAR(std::remainder(phase_lag(scene) - expected, 2 * std::numbers::pi), 0, bound) << frequency;
    }
}

TEST_P(Wave, SlowSignalsTravelAtTwoRadiiTimesTheRootOfStiffnessOverMass) {
    const Scene scene = linear_chain(GetParam(), 73e3);
    const double lag = phase_lag(scene);
    const double per_sphere = chain_frequency(scene);
    const double flight = static_cast<double>(far - near) / per_sphere;  // 2R cancels
    const double turns = std::round((2 * std::numbers::pi * 73e3 * flight - lag) / (2 * std::numbers::pi));
    const double measured = (lag + 2 * std::numbers::pi * turns) / (2 * std::numbers::pi * 73e3);
    EXPECT_NEAR(measured / flight, 1, 0.01);  // dispersion: (omega/omega_0)^2/24 = 0.4 %
}

TEST_P(Wave, DecaysFromSphereToSphereAboveTheCutOff) {
    // no wave of omega > 2 sqrt(k_t/m) travels: cosh(kappa/2) = omega / (2 sqrt(k_t/m)), kappa per sphere
    const double bound = GetParam() == Integrator::leapfrog ? 1e-2 : 1e-3;
    for (const double above : {1.1, 1.3}) {
        Scene scene = linear_chain(GetParam(), 73e3);
        const double frequency = above * chain_frequency(scene) / std::numbers::pi;
        scene.drive.frequency_hz = frequency;
        scene.drive.cycles = 60;
        const Record record = recorded(scene, 4000);
        const double fall = std::abs(component(record, 1, frequency) / component(record, 4, frequency));
        EXPECT_NEAR(std::log(fall) / 3 / (2 * std::acosh(above)), 1, bound) << above;
    }
}

TEST(Waves, SmallOnesTravelAtTheSpeedOfTheLinearChain) {
    // c = 2R sqrt(k_t/m) for long waves; slow drive, small amplitude, no damping, arrival by the burst's peak
    Scene scene;
    scene.chain.spheres = 200;
    scene.chain.damping_kg_per_s = 0;
    scene.drive.amplitude_m = 1e-10;
    scene.drive.frequency_hz = 10e3;
    scene.drive.cycles = 2;
    scene.end.kind = EndKind::wall;
    scene.output.sample_rate_hz = 5e6;
    const Record record = recorded(with_step(scene, Integrator::leapfrog, 50e-9), 2000);
    const auto peak_time = [&](std::size_t sphere) {
        std::size_t at = 0;
        for (std::size_t i = 0; i < 2000; ++i) {
            at = record.chain_v[i * 200 + sphere] > record.chain_v[at * 200 + sphere] ? i : at;
        }
        return static_cast<double>(at) / 5e6;
    };
    const Chain chain(scene);
    const double tangent = tangent_stiffness(chain.stiffness[5], chain.static_overlap[5]);
    const double speed = 1e-3 * std::sqrt(tangent * chain.inv_mass[5]);
    EXPECT_NEAR(100e-3 / (peak_time(120) - peak_time(20)) / speed, 1, 0.01);
}

TEST(StaticEquilibrium, EveryContactCarriesThePreload) {
    for (const EndKind end : {EndKind::plate, EndKind::wall, EndKind::free}) {
        Scene scene;
        scene.end.kind = end;
        const Chain chain(scene);
        const Eigen::Index pressed = end == EndKind::free ? chain.spheres() : chain.bodies();
        for (Eigen::Index c = 0; c < pressed; ++c) {
            EXPECT_NEAR(chain.static_force[c] / 0.1, 1, 1e-14);
            EXPECT_NEAR(chain.stiffness[c] * std::pow(chain.static_overlap[c], 1.5) / 0.1, 1, 1e-14);
        }
    }
}

TEST(StaticEquilibrium, ChainUnderASlowPushComesToWhereTheForcesBalance) {
    // Pushed a micrometre and let go of slowly, a strongly damped chain is at each moment in equilibrium: all
    // contacts carry one force, and their further overlaps add up to the push.
    Scene scene = with_step(Scene{}, Integrator::chin4a, 50e-9);
    scene.end.kind = EndKind::wall;
    scene.drive.frequency_hz = 50;
    scene.drive.cycles = 1;
    scene.drive.envelope = Envelope::rectangular;
    scene.drive.amplitude_m = 1e-6;
    scene.chain.damping_kg_per_s = 1;
    Simulation simulation(scene);
    EXPECT_EQ(simulation.skip(50'000),
              Status::running);  // a quarter of the period: the horn stands still at 1 um
    const ChainState& state = simulation.state();
    double left = 1e-6;
    for (Eigen::Index c = 0; c < simulation.chain().bodies(); ++c) {
        const double overlap = simulation.chain().static_overlap[c] + left - state.x[c];
        const double first = simulation.chain().static_overlap[0] + 1e-6 - state.x[0];
        EXPECT_NEAR(elastic_force(simulation.chain().stiffness[c], overlap) /
                        elastic_force(simulation.chain().stiffness[0], first),
                    1, 2e-5);  // no equilibrium is reached in finite time: 2e-6 remains
        left = state.x[c];
    }
}

}  // namespace
}  // namespace hertzline::test
