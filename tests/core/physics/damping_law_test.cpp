// Laws of damping: collisions against theory, chains against a method of tiny steps.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/contact_law.hpp"
#include "tests/support/bare_chain.hpp"
#include "tests/support/brute_force.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/reference.hpp"

namespace hertzline::test {
namespace {

/// Loose spheres of 1 mm.
Scene loose(Integrator integrator, std::int64_t spheres) {
    constexpr double step_s = 5e-9;
    Scene scene = with_step(Scene{}, integrator, step_s);
    scene.end.kind = EndKind::wall;
    scene.chain.spheres = spheres;
    scene.chain.preload_n = 0;
    return scene;
}

struct Collision {
    double restitution;
    double momentum;  ///< after the collision, relative to before
    double energy;    ///< remaining plus lost energy, relative to before
};

Collision collision_of_spheres(Scene scene, double speed) {
    *scene.numerics.step_s *= std::pow(0.5 / speed, 0.2);  // as collisions last
    BareChain pair(scene);
    pair.state.x.head(2).setConstant(1e-4);  // away from the horn
    pair.state.x[2] = 1;                     // and from the wall
    pair.state.v[0] = speed;
    const double before = kinetic_energy(pair.chain, pair.state);
    pair.advance(4000);
    const Eigen::ArrayXd& v = pair.state.v;
    EXPECT_LE(pair.overlap(1), 0);
    return {.restitution = (v[1] - v[0]) / speed,
            .momentum = (v[0] + v[1]) / speed,
            .energy = (kinetic_energy(pair.chain, pair.state) + pair.lost) / before};
}

Collision collision_with_the_wall(Scene scene, double speed) {
    *scene.numerics.step_s *= std::pow(0.5 / speed, 0.2);
    scene.chain.spheres = 1;
    BareChain sphere(scene);
    sphere.state.x.setConstant(1e-4);  // away from the horn
    sphere.state.v[0] = speed;
    const double before = kinetic_energy(sphere.chain, sphere.state);
    sphere.advance(2000);
    EXPECT_LE(sphere.overlap(1), 0);
    return {.restitution = -sphere.state.v[0] / speed,
            .momentum = 1,
            .energy = (kinetic_energy(sphere.chain, sphere.state) + sphere.lost) / before};
}

class DampedCollision : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Series, DampedCollision, ::testing::ValuesIn(series_integrators()), integrator_name);

Scene kuwabara_kono(Scene scene, double time_s) {
    scene.chain.damping_law = DampingLaw::kuwabara_kono;
    scene.chain.damping_time_s = time_s;
    return scene;
}

Scene tsuji(Scene scene, double alpha) {
    scene.chain.damping_law = DampingLaw::tsuji;
    scene.chain.damping_alpha = alpha;
    return scene;
}

/// Returns 1 - e of two spheres by the first two terms of Ramirez et al., Phys. Rev. E 60 (1999) 4465, equation (25).
double loss_by_series(const Scene& scene, double speed) {
    const Chain chain(scene);
    const double reduced_mass = 0.5 / chain.inv_mass[0];
    const double beta = 1.5 * *scene.chain.damping_time_s * std::pow(chain.stiffness[1] / reduced_mass, 0.4);
    const double term = beta * std::pow(speed, 0.2);
    return 1.15344 * term - 0.79826 * term * term;
}

TEST_P(DampedCollision, OfKuwabaraAndKonoLosesByTheFifthRootOfItsSpeed) {
    const Scene scene = kuwabara_kono(loose(GetParam(), 2), 1e-9);
    std::vector<double> losses;
    for (const double speed : {0.01, 0.1, 1.0}) {
        const Collision hit = collision_of_spheres(scene, speed);
        losses.push_back(1 - hit.restitution);
        EXPECT_NEAR(losses.back() / loss_by_series(scene, speed), 1, 1e-4) << speed;
        EXPECT_NEAR(hit.momentum, 1, 1e-12);
        EXPECT_NEAR(hit.energy, 1, 1e-9);
    }
    EXPECT_NEAR(std::log10(losses[1] / losses[0]), 0.2, 1e-3);
    EXPECT_NEAR(std::log10(losses[2] / losses[1]), 0.2, 1e-3);
}

TEST_P(DampedCollision, OfTsujiHasARestitutionThatDoesNotDependOnSpeedMassesOrStiffness) {
    for (const double alpha : {0.01, 0.1, 0.5, 1.5}) {
        const Scene scene = tsuji(loose(GetParam(), 2), alpha);
        const double expected = std::exp(-std::numbers::pi * alpha / std::sqrt(5 - alpha * alpha));
        for (const double speed : {0.01, 0.1, 1.0}) {
            for (const Collision& hit :
                 {collision_of_spheres(scene, speed), collision_with_the_wall(scene, speed)}) {
                EXPECT_NEAR(hit.restitution / expected, 1, 1e-8) << alpha << ' ' << speed;
                EXPECT_NEAR(hit.momentum, 1, 1e-12);
                EXPECT_NEAR(hit.energy, 1, 1e-8);
            }
        }
    }
}

TEST_P(DampedCollision, OfTsujiDoesNotReboundFromAlphaOfRootFiveOn) {
    BareChain sphere(tsuji(loose(GetParam(), 1), 2.3));
    sphere.state.x.setConstant(1e-4);
    sphere.state.v[0] = 0.5;
    sphere.advance(20'000);
    EXPECT_GT(sphere.overlap(1), 0);
    EXPECT_GT(sphere.state.v[0], -1e-2);
    EXPECT_LT(sphere.state.v[0], 0);  // creeps back
}

TEST_P(DampedCollision, ThatLetsGoBeforeItPullsReboundsFaster) {
    for (const Scene& law : {kuwabara_kono(loose(GetParam(), 2), 3e-7), tsuji(loose(GetParam(), 2), 0.5)}) {
        Scene scene = law;
        const Collision allowed = collision_of_spheres(scene, 0.5);
        scene.chain.tension = Tension::clamped;
        const Collision clamped = collision_of_spheres(scene, 0.5);
        EXPECT_GT(clamped.restitution, 1.01 * allowed.restitution);
        EXPECT_NEAR(clamped.energy, 1, 1e-7);  // energy stored at the opening is lost
    }
}

TEST(DampingLaw, IsInTheForceOnTheEnd) {
    for (const Scene& law : {kuwabara_kono(Scene{}, 3e-7), tsuji(Scene{}, 0.3)}) {
        Scene scene = with_step(law, Integrator::taylor12, 2e-7);
        scene.end.kind = EndKind::wall;
        scene.chain.spheres = 1;
        constexpr std::size_t rows = 2000;
        Simulation simulation(scene, {.taps = everything});
        Samples samples = simulation.make_samples(rows);
        ASSERT_EQ(simulation.advance(samples, rows), Status::running);
        const Chain& chain = simulation.chain();
        double strongest = 0;
        for (std::size_t i = 0; i < rows; ++i) {
            const double overlap = chain.static_overlap[1] + samples[Tap::x_chain][i];
            const double elastic = elastic_force(chain.stiffness[1], overlap);
            const double factor = scene.chain.damping_law == DampingLaw::tsuji
                                      ? 0.3 * std::sqrt(chain.stiffness[1] / chain.inv_mass[0])
                                      : 1.5 * 3e-7 * chain.stiffness[1];
            const double power = scene.chain.damping_law == DampingLaw::tsuji ? 0.25 : 0.5;
            const double loss = factor * std::pow(std::max(overlap, 0.0), power) * samples[Tap::v_chain][i];
            EXPECT_NEAR(samples[Tap::f_last][i], elastic + loss, 1e-12) << i;
            strongest = std::max(strongest, std::abs(loss));
        }
        EXPECT_GT(strongest, 0.1);
    }
}

TEST(DampingLaw, KeepsLedgerAndAccuracyWithAModalPlate) {
    constexpr std::size_t rows = 3001;
    constexpr TapSet outputs = TapSet(Tap::v_last) | Tap::v_centre | Tap::v_face | Tap::p_axis;
    const auto run = [&](Simulation& simulation) {
        Samples samples = simulation.make_samples(rows);
        EXPECT_EQ(simulation.advance(samples, rows), Status::running);
        return samples;
    };
    for (const Scene& law : {kuwabara_kono(Scene{}, 3e-7), tsuji(Scene{}, 0.3)}) {
        for (const Tension tension : choices<Tension>) {
            Scene scene = law;
            scene.end.model = PlateModel::modal;
            scene.chain.tension = tension;
            scene = settled(scene);
            Simulation simulation(scene, {.taps = outputs});
            Simulation better(with_step(scene, Integrator::taylor12, 5e-8), {.taps = outputs});
            const Samples samples = run(simulation);
            const Samples exact = run(better);
            EXPECT_GT(simulation.contact_events(), 20);
            EXPECT_LE(simulation.energy_residual(), 1e-4);
            EXPECT_LE(better.energy_residual(), 1e-9);
            for (const Tap tap : outputs) {
                EXPECT_LE(relative_l2(samples[tap], exact[tap]), 1e-4) << row_of(tap).name;
            }
        }
    }
}

struct Damped {
    std::string name;
    Scene scene;
};

/// Driven chains of few spheres over 100 us, whose contacts open and close, or do not.
std::vector<Damped> damped_scenes() {
    Scene scene;
    scene.chain.spheres = 4;
    scene.drive.cycles = 5;
    scene.output.duration_s = 100e-6;
    scene.output.sample_rate_hz = 5e6;
    std::vector<Damped> scenes;
    const auto add = [&](const std::string& name, const auto& change) {
        Scene changed = scene;
        change(changed);
        scenes.push_back({"kuwabara_kono_" + name, kuwabara_kono(changed, 2e-7)});
        scenes.push_back({"tsuji_" + name, tsuji(changed, 0.2)});
    };
    add("plate", [](Scene&) {});
    add("wall", [](Scene& s) { s.end.kind = EndKind::wall; });
    add("free_end", [](Scene& s) { s.end.kind = EndKind::free; });
    add("no_preload", [](Scene& s) { s.chain.preload_n = 0; });
    add("clamped", [](Scene& s) {
        s.chain.tension = Tension::clamped;
        s.end.kind = EndKind::wall;
    });
    add("gentle", [](Scene& s) { s.drive.amplitude_m = 1e-9; });
    add("twenty_spheres", [](Scene& s) { s.chain.spheres = 20; });
    return scenes;
}

class DampedChain : public ::testing::TestWithParam<Damped> {
protected:
    std::size_t rows() const {
        return static_cast<std::size_t>(
                   std::lround(GetParam().scene.output.duration_s * GetParam().scene.output.sample_rate_hz)) +
               1;
    }

    /// Returns all spheres' velocities by brute force [m/s].
    std::vector<double> reference() const {
        BruteForce brute(GetParam().scene);
        const std::vector<double> all = brute.velocities(rows());
        const std::size_t spheres = brute.bodies() - 1;
        std::vector<double> of_spheres;
        for (std::size_t i = 0; i < rows(); ++i) {
            const auto row = all.begin() + static_cast<std::ptrdiff_t>(i * brute.bodies());
            of_spheres.insert(of_spheres.end(), row, row + static_cast<std::ptrdiff_t>(spheres));
        }
        return of_spheres;
    }

    double error(const Scene& scene, const std::vector<double>& exact) const {
        return relative_l2(recorded(scene, rows()).chain_v, exact);
    }
};
INSTANTIATE_TEST_SUITE_P(Scenes, DampedChain, ::testing::ValuesIn(damped_scenes()),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(DampedChain, MovesAsTinyStepsSay) {
    const std::vector<double> exact = reference();
    EXPECT_LE(error(with_step(GetParam().scene, Integrator::taylor12, 2e-7), exact), 1e-9);
    for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
        Scene scene = GetParam().scene;
        scene.numerics.accuracy = accuracy;
        const Resolution resolved = resolve(scene);
        ASSERT_TRUE(resolved.estimate.has_value());
        const double found = error(resolved.scene, exact);
        EXPECT_LE(found, accuracy);
        EXPECT_LE(found, 3 * resolved.estimate->error);
        EXPECT_LE(resolved.estimate->error, accuracy);
    }
}

TEST_P(DampedChain, HasALedgerThatCloses) {
    for (const Integrator integrator : series_integrators()) {
        Simulation simulation(with_step(GetParam().scene, integrator, 25e-9));
        EXPECT_EQ(simulation.skip(rows()), Status::running);
        EXPECT_GT(simulation.ledger().lost, 0);
        EXPECT_LE(simulation.energy_residual(), 1e-7) << word(integrator);
    }
}

}  // namespace
}  // namespace hertzline::test
