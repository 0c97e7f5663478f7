// Contacts that open and close in awkward ways: together, barely, repeatedly. Every failure must be reported.

#include <cmath>

#include <gtest/gtest.h>

#include "core/model/contact_law.hpp"
#include "tests/support/bare_chain.hpp"
#include "tests/support/integrators.hpp"

namespace hertzline::test {
namespace {

class ContactEvents : public ::testing::TestWithParam<Integrator> {
protected:
    /// Returns the bound of the method's own error [1].
    double bound(double of_leapfrog, double where_contacts_are_located) const {
        return GetParam() == Integrator::leapfrog ? of_leapfrog : where_contacts_are_located;
    }

    /// Spheres that nothing holds together and that lose nothing, a gap [m] away from the horn.
    BareChain loose(std::int64_t spheres, double gap, double step_s = 10e-9) const {
        Scene scene = with_step(Scene{}, GetParam(), step_s);
        scene.end.kind = EndKind::free;
        scene.chain.spheres = spheres;
        scene.chain.preload_n = 0;
        scene.chain.damping_kg_per_s = 0;
        BareChain chain(scene);
        chain.state.x.setConstant(gap);
        return chain;
    }
};
INSTANTIATE_TEST_SUITE_P(Integrators, ContactEvents, every_integrator, integrator_name);

TEST_P(ContactEvents, MirrorImagesStayMirrorImagesWhenContactsSwitchTogether) {
    // 2n + 1 spheres, those to the left thrown at the middle one and their mirror images, too
    for (const Eigen::Index n : {1, 2, 3, 7}) {
        BareChain chain = loose(2 * n + 1, 1e-3);
        for (Eigen::Index b = 0; b < n; ++b) {
            const double gap = 1e-7 * static_cast<double>((n - b) * (n - b));
            chain.state.x[b] -= gap;
            chain.state.x[2 * n - b] += gap;
            chain.state.v[b] = 0.3;
            chain.state.v[2 * n - b] = -0.3;
        }
        const double energy = chain.energy();
        chain.advance(20000);
        double worst = std::abs(chain.state.v[n]);
        for (Eigen::Index b = 0; b < n; ++b) {
            worst = std::max(worst, std::abs(chain.state.v[b] + chain.state.v[2 * n - b]));
        }
        EXPECT_LE(worst, 1e-10) << n;
        EXPECT_NEAR(chain.energy() / energy, 1, bound(5e-6, 5e-8)) << n;
        EXPECT_EQ(chain.contact_events() % 4, 0) << n;  // opening and closing, left and right
        EXPECT_LT(chain.state.v[0], -0.1) << n;         // they have parted
    }
}

TEST_P(ContactEvents, TheFaintestImpactExchangesVelocitiesAsAStrongOneDoes) {
    // Hertz's law knows no scale: lengths go with speed^(4/5), times with speed^(-1/5)
    for (const double speed : {1e-1, 1e-4, 1e-8, 1e-16, 1e-60}) {
        const double length = 1e-6 * std::pow(speed, 0.8);
        const double duration = 3e-6 * std::pow(speed, -0.2);
        BareChain pair = loose(2, 20 * length, duration / 300);
        pair.state.v[0] = speed;
        pair.advance(500);
        EXPECT_NEAR(pair.state.v[0] / speed, 0, bound(1e-6, 5e-8)) << speed;
        EXPECT_NEAR(pair.state.v[1] / speed, 1, bound(1e-6, 5e-8)) << speed;
        EXPECT_EQ(pair.contact_events(), 2) << speed;
    }
}

TEST_P(ContactEvents, TheFaintestOverlapPushesAsHertzSays) {
    // two spheres let go while they overlap: the energy (2/5) k delta^(5/2) is shared
    for (const double overlap : {1e-6, 1e-12, 1e-24, 1e-100}) {
        if (is_series(GetParam()) && overlap < 1e-50) {
            continue;  // a series does not resolve overlaps that far below an atom's size
        }
        const Chain chain = loose(2, 0).chain;
        const double rate = std::sqrt(chain.stiffness[1] * chain.inv_mass[0]) * std::pow(overlap, 0.25);
        BareChain pair = loose(2, 20 * overlap, 0.005 / rate);
        pair.state.x[0] += overlap;
        pair.advance(1000);
        const double expected = std::sqrt(0.4) * rate * overlap;
        EXPECT_NEAR(pair.state.v[0] / expected, -1, bound(5e-5, 5e-8)) << overlap;
        EXPECT_NEAR(pair.state.v[1] / expected, 1, bound(5e-5, 5e-8)) << overlap;
        EXPECT_EQ(pair.contact_events(), 1) << overlap;
    }
    BareChain pair = loose(2, 1e-5);
    for (const double least : {0.0, 5e-324}) {
        pair.state.x << least, 0, 0;
        pair.advance(1000);
        const double most = is_series(GetParam()) ? 1e-200 : 0;
        EXPECT_LE(std::abs(pair.state.x[1]), most);
        EXPECT_LE(std::abs(pair.state.v[1]), most);
    }
}

TEST_P(ContactEvents, AContactThatOpensByAHairIsNoTrouble) {
    // a sphere between horn and wall, let go where its left contact is just open, just touches, is just
    // closed: it comes back there once a period
    for (const double hair : {1e-3, 1e-6, 1e-12, 0.0, -1e-12, -1e-6, -1e-3}) {
        Scene scene = with_step(Scene{}, GetParam(), 20e-9);
        scene.end.kind = EndKind::wall;
        scene.chain.spheres = 1;
        scene.chain.damping_kg_per_s = 0;
        BareChain sphere(scene);
        const double at_rest = sphere.energy();
        sphere.state.x[0] = sphere.chain.static_overlap[0] * (1 + hair);
        const double energy = sphere.energy() - at_rest;
        const double closed = sphere.overlap(0) > 0 ? 1 : 0;
        sphere.advance(100'000);
        const bool same = sphere.state.closed[0] == closed;
        EXPECT_NEAR((sphere.energy() - at_rest) / energy, 1, bound(1e-3, 5e-9)) << hair;
        EXPECT_EQ(sphere.contact_events() % 2, same ? 0 : 1) << hair;
    }
}

TEST_P(ContactEvents, ABouncingSphereComesToRestAndTheLedgerHasAllThatItLost) {
    for (const Tension tension : choices<Tension>) {
        for (const double damping : {0.02, 0.3, 2.0}) {
            Scene scene = with_step(Scene{}, GetParam(), 20e-9);
            scene.end.kind = EndKind::free;
            scene.chain.spheres = 1;
            scene.chain.preload_n = 0.01;
            scene.chain.damping_kg_per_s = damping;
            scene.chain.tension = tension;
            BareChain sphere(scene);
            const double at_rest = sphere.energy();
            sphere.state.v[0] = 0.1;
            const double put_in = sphere.energy() - at_rest;
            sphere.advance(200'000);
            EXPECT_LE(std::abs(sphere.state.v[0]), 1e-11);
            EXPECT_LE(std::abs(sphere.state.x[0]), 1e-16);
            EXPECT_EQ(sphere.state.closed[0], 1);
            EXPECT_EQ(sphere.contact_events() % 2, 0);
            EXPECT_NEAR(sphere.lost / put_in, 1, bound(1e-3, 2e-5)) << damping;
        }
    }
}

/// Returns the number of contacts that differ from their state at rest.
std::int64_t switched(Simulation& simulation) {
    const ChainState at_rest(simulation.chain());
    return (simulation.state().closed != at_rest.closed).count();
}

TEST_P(ContactEvents, ComeInPairsWhateverTheScene) {
    for (const EndKind end : choices<EndKind>) {
        for (const Tension tension : choices<Tension>) {
            for (const double preload : {0.0, 1e-6, 0.1}) {
                for (const double damping : {0.0, 0.02, 0.32, 2.0}) {
                    Scene scene = with_step(Scene{}, GetParam(), 25e-9);
                    scene.end.kind = end;
                    scene.chain.tension = tension;
                    scene.chain.preload_n = preload;
                    scene.chain.damping_kg_per_s = damping;
                    Simulation simulation(scene);
                    EXPECT_EQ(simulation.skip(5000), Status::running);
                    EXPECT_LE(simulation.energy_residual(), bound(5e-3, 2e-4));
                    EXPECT_GT(simulation.contact_events(), 0);
                    EXPECT_EQ((simulation.contact_events() - switched(simulation)) % 2, 0);
                }
            }
        }
    }
}

}  // namespace
}  // namespace hertzline::test
