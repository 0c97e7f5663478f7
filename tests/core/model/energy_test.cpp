// The energy ledger closes in any scene; undamped chains keep their energy; symmetric methods can go back.

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/bare_chain.hpp"
#include "tests/support/integrators.hpp"

namespace hertzline::test {
namespace {

struct LedgerCase {
    std::string name;
    std::function<void(Scene&)> change;
};

const std::vector<LedgerCase>& ledger_cases() {
    static const std::vector<LedgerCase> cases{
        {"plate", [](Scene&) {}},
        {"wall", [](Scene& s) { s.end.kind = EndKind::wall; }},
        {"free_end", [](Scene& s) { s.end.kind = EndKind::free; }},
        {"unbalanced_plate", [](Scene& s) { s.end.preload = PlatePreload::as_printed; }},
        {"soft_plate", [](Scene& s) { s.end.material = "silicone_rubber"; }},
        {"no_preload", [](Scene& s) { s.chain.preload_n = 0; }},
        {"undamped", [](Scene& s) { s.chain.damping_kg_per_s = 0; }},
        {"one_sphere", [](Scene& s) { s.chain.spheres = 1; }},
        {"forty_spheres", [](Scene& s) { s.chain.spheres = 40; }},
        {"rectangular", [](Scene& s) { s.drive.envelope = Envelope::rectangular; }},
        {"tukey_that_ends_amid_a_cycle",
         [](Scene& s) {
             s.drive.envelope = Envelope::tukey;
             s.drive.cycles = 10.3;
         }},
        {"repeated_one_cycle_bursts",
         [](Scene& s) {
             s.drive.envelope = Envelope::rectangular;
             s.drive.cycles = 1;
             s.drive.repetition_hz = 31e3;
         }},
    };
    return cases;
}

double residual(Scene scene, const std::function<void(Scene&)>& change, Integrator integrator,
                double step_s) {
    change(scene);
    Simulation simulation(with_step(scene, integrator, step_s));
    EXPECT_EQ(simulation.skip(4001), Status::running);
    EXPECT_GT(simulation.ledger().work, 0);
    return simulation.energy_residual();
}

class Ledger : public ::testing::TestWithParam<LedgerCase> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Ledger, ::testing::ValuesIn(ledger_cases()),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(Ledger, ClosesAndClosesFourfoldBetterWithHalfTheStepOfLeapfrog) {
    const double coarse = residual(Scene{}, GetParam().change, Integrator::leapfrog, 25e-9);
    const double fine = residual(Scene{}, GetParam().change, Integrator::leapfrog, 12.5e-9);
    EXPECT_LE(coarse, 2e-3);
    EXPECT_LE(fine, 5e-4);
    if (GetParam().name != "undamped") {  // chaotic: another step is another motion
        EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15);
    }
}

TEST_P(Ledger, ClosesToPartsInAMillionWhereContactsAreLocated) {
    for (const Integrator integrator : locating_integrators()) {
        EXPECT_LE(residual(Scene{}, GetParam().change, integrator, 25e-9), 2e-5) << word(integrator);
        EXPECT_LE(residual(Scene{}, GetParam().change, integrator, 6.25e-9), 5e-7) << word(integrator);
    }
}

void clamped(Scene& scene) {
    scene.chain.tension = Tension::clamped;
}

TEST(ClampedLedger, ClosesWithLeapfrog) {
    const double coarse = residual(Scene{}, clamped, Integrator::leapfrog, 25e-9);
    const double fine = residual(Scene{}, clamped, Integrator::leapfrog, 12.5e-9);
    EXPECT_LE(coarse, 2e-3);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15);
}

TEST(ClampedLedger, ClosesWhereContactsAreLocated) {
    // a clamped contact lets go while it is still pressed; its stored energy is then lost
    for (const Integrator integrator : locating_integrators()) {
        EXPECT_LE(residual(Scene{}, clamped, integrator, 25e-9), 1e-5) << word(integrator);
    }
}

TEST(ClampedLedger, OfASeriesIsAsGoodAsItsMotion) {
    // spheres that come apart: contacts let go, and relax, at any moment of a piece
    const auto apart = [](Scene& scene) {
        clamped(scene);
        scene.chain.material = "steel";
        scene.chain.preload_n = 0;
        scene.chain.damping_kg_per_s = 0.494;
    };
    EXPECT_LE(residual(Scene{}, apart, Integrator::taylor12, 200e-9), 1e-10);
}

TEST(JumpLedger, ClosesWhenARectangularBurstEndsAmidACycle) {
    // the horn jumps back to zero, and the pressed contact pushes it
    const auto cut_short = [](Scene& scene) {
        scene.drive.envelope = Envelope::rectangular;
        scene.drive.cycles = 10.25;
    };
    const auto long_and_cut_short = [&](Scene& scene) {
        cut_short(scene);
        scene.chain.spheres = 100;  // leapfrog sweeps along it
        scene.end.kind = EndKind::wall;
    };
    for (const Integrator integrator : locating_integrators()) {
        EXPECT_LE(residual(Scene{}, cut_short, integrator, 25e-9), 1e-5) << word(integrator);
    }
    for (const std::function<void(Scene&)>& change :
         {std::function<void(Scene&)>(cut_short), std::function<void(Scene&)>(long_and_cut_short)}) {
        const double coarse = residual(Scene{}, change, Integrator::leapfrog, 25e-9);
        EXPECT_LE(coarse, 1e-3);
        EXPECT_LE(residual(Scene{}, change, Integrator::leapfrog, 12.5e-9), coarse / 2);
    }
}

TEST(Ledger, CountsWhatTheHornGetsBack) {
    // an undamped chain at a small amplitude gives nearly all of it back
    Scene scene;
    scene.chain.damping_kg_per_s = 0;
    scene.drive.amplitude_m = 1e-9;
    for (const Integrator integrator : choices<Integrator>) {
        Simulation simulation(with_step(scene, integrator, 25e-9));
        EXPECT_EQ(simulation.skip(static_cast<std::int64_t>(300e-6 * scene.output.sample_rate_hz)),
                  Status::running);
        const hertzline::Ledger ledger = simulation.ledger();
        EXPECT_GT(ledger.gross_work, 3 * std::abs(ledger.work)) << word(integrator);
        EXPECT_NEAR(simulation.energy_residual(),
                    simulation.energy_missing() / std::max(ledger.gross_work, ledger.lost),
                    1e-3 * simulation.energy_residual())
            << word(integrator);
    }
}

TEST(Undamped, EnergyNeitherGrowsNorFallsInAMillionSteps) {
    for (const Integrator integrator : choices<Integrator>) {
        const double bound = integrator == Integrator::leapfrog ? 1.5e-3 : 1.5e-5;
        const double at_rest = thrown(integrator, 20e-9, 0).energy();
        BareChain chain = thrown(integrator, 20e-9, 0.3);
        const double put_in = chain.energy() - at_rest;
        EXPECT_LE(largest_energy_change(chain, at_rest, put_in, 1'000'000), bound) << word(integrator);
    }
}

TEST(Undamped, TheErrorOfSymplecticMethodsStaysWhereItIsWhileContactsStayClosed) {
    for (const auto& [integrator, bound] :
         {std::pair{Integrator::leapfrog, 1e-3}, {Integrator::chin4a, 5e-9}}) {
        const double at_rest = thrown(integrator, 20e-9, 0).energy();
        BareChain chain = thrown(integrator, 20e-9, 3e-3);
        const double put_in = chain.energy() - at_rest;
        const double first = largest_energy_change(chain, at_rest, put_in, 100'000);
        const double later = largest_energy_change(chain, at_rest, put_in, 900'000);
        EXPECT_EQ(chain.contact_events(), 0);
        EXPECT_LE(first, bound) << word(integrator);
        EXPECT_LE(later, 1.1 * first) << word(integrator);
    }
}

/// Advances, reverses the velocities and advances again. Returns the largest distance from the start [m].
double distance_from_start(BareChain chain, std::int64_t steps) {
    const Eigen::ArrayXd start = chain.state.x;
    chain.advance(steps);
    EXPECT_GT((chain.state.x - start).abs().maxCoeff(), 1e-10);
    chain.state.v *= -1;
    chain.advance(steps);
    return (chain.state.x - start).abs().maxCoeff();
}

TEST(Undamped, SymmetricMethodsRetraceTheirStepsWhileContactsStayClosed) {
    for (const Integrator integrator : {Integrator::leapfrog, Integrator::chin4a}) {
        EXPECT_LE(distance_from_start(thrown(integrator, 100e-9, 1e-3), 5000), 2e-21);
    }
}

TEST(Undamped, LeapfrogRetracesEvenThroughOpeningsUntilRoundingHasGrown) {
    EXPECT_LE(distance_from_start(thrown(Integrator::leapfrog, 20e-9, 0.3), 2000), 5e-20);
}

TEST(Energy, IsKeptByAnUndampedChainOnceTheHornRests) {
    Scene scene;
    scene.chain.damping_kg_per_s = 0;
    scene.drive.cycles = 3;
    scene.drive.frequency_hz = 300e3;
    Simulation simulation(with_step(scene, Integrator::chin4a, 25e-9), {.taps = everything});
    Samples part = simulation.make_samples(1000);
    EXPECT_EQ(simulation.advance(part, 200), Status::running);
    const auto energy = [&] {
        return kinetic_energy(simulation.chain(), simulation.state()) +
               stored_energy(simulation.chain(), simulation.state(), 0);
    };
    const double before = energy();
    for (int i = 0; i < 50; ++i) {
        EXPECT_EQ(simulation.advance(part, 1000), Status::running);
    }
    EXPECT_NEAR(energy() / before, 1, 1e-5);
    EXPECT_EQ(simulation.ledger().lost, 0);
}

TEST(Energy, DampingOnlyEverLoses) {
    Simulation simulation(with_step(Scene{}, Integrator::chin4a, 50e-9), {.taps = everything});
    Samples part = simulation.make_samples(10);
    double lost = 0;
    for (int i = 0; i < 500; ++i) {
        EXPECT_EQ(simulation.advance(part, 10), Status::running);
        EXPECT_GE(simulation.ledger().lost, lost);
        lost = simulation.ledger().lost;
    }
    EXPECT_GT(lost, 0);
    EXPECT_LE(simulation.energy_residual(), 1e-5);
}

}  // namespace
}  // namespace hertzline::test
