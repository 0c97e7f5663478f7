// Contacts that may pull for an instant before they open, and those that let go instead.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/integrators.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

TEST(Tension, ClampedContactsNeverPull) {
    for (const Integrator integrator : choices<Integrator>) {
        Scene scene = with_step(Scene{}, integrator, 10e-9);
        scene.output.sample_rate_hz = 100e6;
        scene.end.kind = EndKind::wall;
        const Record allowed = recorded(scene, 30000);
        scene.chain.tension = Tension::clamped;
        const Record clamped = recorded(scene, 30000);
        const Chain chain(scene);
        // a sphere that its left neighbour has let go of is accelerated by the right contact alone, which
        // must push it back
        const auto pulls_on = [&](const Record& r, std::size_t sphere) {
            const auto apart = [&](std::size_t at) {
                const double gap = r.chain_x[at * 6 + sphere] - r.chain_x[at * 6 + sphere - 1];
                return gap > chain.static_overlap[static_cast<Eigen::Index>(sphere)];
            };
            int count = 0;
            for (std::size_t i = 1; i + 1 < 30000; ++i) {
                const double acceleration =
                    (r.chain_v[(i + 1) * 6 + sphere] - r.chain_v[(i - 1) * 6 + sphere]) / 2e-8;
                count += apart(i - 1) && apart(i) && apart(i + 1) && acceleration / chain.inv_mass[5] > 1e-3
                             ? 1
                             : 0;
            }
            return count;
        };
        const auto pulls = [&](const Record& r) {
            int count = 0;
            for (std::size_t sphere = 1; sphere < 6; ++sphere) {
                count += pulls_on(r, sphere);
            }
            return count;
        };
        EXPECT_GT(pulls(allowed), 0);
        EXPECT_EQ(pulls(clamped), 0);
    }
}

TEST(Tension, ClampedRunsConvergeAndAllIntegratorsAgree) {
    Scene scene;
    scene.chain.tension = Tension::clamped;
    const Record fine = recorded(with_step(scene, Integrator::chin4a, 3.125e-9), 4000);
    const auto error = [&](Integrator integrator, double step) {
        const Record coarse = recorded(with_step(scene, integrator, step), 4000);
        return relative_l2(coarse.v_last, fine.v_last);
    };
    for (const Integrator integrator : locating_integrators()) {
        EXPECT_LT(error(integrator, 50e-9), 1e-5) << word(integrator);
    }
    EXPECT_LT(error(Integrator::leapfrog, 12.5e-9), 5e-4);
    EXPECT_LT(error(Integrator::leapfrog, 6.25e-9), 0.4 * error(Integrator::leapfrog, 12.5e-9));
}

TEST(Tension, WithoutDashpotsThereIsNothingToClamp) {
    for (const Integrator integrator : choices<Integrator>) {
        for (const double preload : {0.0, 0.1}) {
            Scene scene = with_step(Scene{}, integrator, 25e-9);
            scene.chain.damping_kg_per_s = 0;
            scene.chain.preload_n = preload;
            const Record allowed = recorded(scene, 2000);
            scene.chain.tension = Tension::clamped;
            EXPECT_EQ(recorded(scene, 2000), allowed) << word(integrator);
        }
    }
}

}  // namespace
}  // namespace hertzline::test
