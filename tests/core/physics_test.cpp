// Physics that is known without a simulation: impacts, waves, springs, conservation.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/coupling.hpp"
#include "core/hertz.hpp"
#include "core/scene_words.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

const Solid& solid(const char* name) {
    static const Scene scene;
    return std::get<Solid>(*find_material(scene, name));
}

TEST(Contact, TheStaticOverlapCarriesThePreload) {
    for (const EndKind end : {EndKind::plate, EndKind::wall}) {
        Scene scene;
        scene.end.kind = end;
        const Chain chain(scene);
        for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
            EXPECT_NEAR(elastic_force(chain.stiffness[c], chain.static_overlap[c]), 0.1, 1e-16);
        }
    }
}

TEST(Contact, ForceIsTheSlopeOfEnergyAndTangentTheSlopeOfForce) {
    constexpr double k = 1e9;
    for (const double overlap : {1e-8, 3e-7, 5e-6}) {
        const double d = overlap * 1e-4;
        const double force = (elastic_energy(k, overlap + d) - elastic_energy(k, overlap - d)) / (2 * d);
        const double tangent = (elastic_force(k, overlap + d) - elastic_force(k, overlap - d)) / (2 * d);
        EXPECT_NEAR(force / elastic_force(k, overlap), 1, 1e-7);
        EXPECT_NEAR(tangent / tangent_stiffness(k, overlap), 1, 1e-7);
    }
    EXPECT_EQ(elastic_force(k, -1e-9), 0);
    EXPECT_EQ(tangent_stiffness(k, -1e-9), 0);
    EXPECT_EQ(elastic_energy(k, -1e-9), 0);
}

TEST(Coupling, PlateStiffnessesAreThoseOfTheory) {
    const std::vector<std::pair<const char*, double>> table{{"silicone_rubber", 2.76e3},
                                                            {"acrylic", 5.97e4},
                                                            {"vitreous_carbon", 7.50e5},
                                                            {"pyrex", 1.46e6},
                                                            {"aluminium", 1.62e6}};
    for (const auto& [name, stiffness] : table) {
        EXPECT_NEAR(plate_stiffness(solid(name), End{}) / stiffness, 1, 0.005) << name;
    }
}

TEST(Coupling, TransmissionsAreThoseOfTheImpedances) {
    const std::vector<std::pair<const char*, double>> table{{"aluminium", 0.5480},
                                                            {"pyrex", 0.6030},
                                                            {"vitreous_carbon", 0.6902},
                                                            {"acrylic", 0.6290},
                                                            {"silicone_rubber", 0.5305}};
    for (const auto& [name, factor] : table) {
        Scene scene;
        scene.end.material = name;
        EXPECT_NEAR(output_transmission(scene), factor, 5e-5) << name;
        EXPECT_EQ(Chain(scene).transmission, output_transmission(scene));
    }
}

TEST(Chain, MassesAreThoseOfSpheresAndAQuarterOfTheDisc) {
    const Chain chain{Scene{}};
    EXPECT_NEAR(1 / chain.inv_mass[0], 1.4137e-6, 1e-10);
    EXPECT_NEAR(1 / chain.inv_mass[6], 1420 * std::numbers::pi * 25e-6 * 0.5e-3 / 4, 1e-12);
}

TEST(Impact, LastsAsLongAsHertzSays) {
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
    const Record record = recorded(with_step(scene, Integrator::chin4a, 10e-9), 200'000, 1024);
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

TEST(Waves, SmallOnesTravelAtTheSpeedOfTheLinearChain) {
    // c = 2R sqrt(k_t/m) for long waves; a slow drive, small amplitude, no damping, arrival by the peak of
    // the burst
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

TEST(Energy, IsKeptByAnUndampedChainOnceTheHornRests) {
    Scene scene;
    scene.chain.damping_kg_per_s = 0;
    scene.drive.cycles = 3;
    scene.drive.frequency_hz = 300e3;
    Simulation simulation(with_step(scene, Integrator::chin4a, 25e-9), everything);
    Samples part(simulation.chain(), 1000, everything);
    simulation.advance(part, 200, everything);
    const auto energy = [&] {
        return kinetic_energy(simulation.chain(), simulation.state()) +
               stored_energy(simulation.chain(), simulation.state(), 0);
    };
    const double before = energy();
    for (int i = 0; i < 50; ++i) {
        simulation.advance(part, 1000, everything);
    }
    EXPECT_NEAR(energy() / before, 1, 1e-5);
    EXPECT_EQ(simulation.ledger().lost, 0);
}

TEST(Energy, DampingOnlyEverLoses) {
    Simulation simulation(with_step(Scene{}, Integrator::chin4a, 50e-9), everything);
    Samples part(simulation.chain(), 10, everything);
    double lost = 0;
    for (int i = 0; i < 500; ++i) {
        simulation.advance(part, 10, everything);
        EXPECT_GE(simulation.ledger().lost, lost);
        lost = simulation.ledger().lost;
    }
    EXPECT_GT(lost, 0);
    EXPECT_LE(simulation.energy_residual(), 1e-5);
}

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

TEST(Tension, ClampedRunsConvergeAndBothIntegratorsAgree) {
    Scene scene;
    scene.chain.tension = Tension::clamped;
    const Record fine = recorded(with_step(scene, Integrator::chin4a, 3.125e-9), 4000);
    const auto error = [&](Integrator integrator, double step) {
        const Record coarse = recorded(with_step(scene, integrator, step), 4000);
        double difference = 0;
        double norm = 0;
        for (std::size_t i = 0; i < 4000; ++i) {
            difference += std::pow(coarse.v_last[i] - fine.v_last[i], 2);
            norm += std::pow(fine.v_last[i], 2);
        }
        return std::sqrt(difference / norm);
    };
    EXPECT_LT(error(Integrator::chin4a, 50e-9), 1e-5);
    EXPECT_LT(error(Integrator::leapfrog, 12.5e-9), 5e-4);
    EXPECT_LT(error(Integrator::leapfrog, 6.25e-9), 0.4 * error(Integrator::leapfrog, 12.5e-9));
}

TEST(Preload, AsPrintedStartsThePlateWithAKick) {
    Scene scene;
    scene.end.preload = PlatePreload::as_printed;
    const Record record = recorded(with_step(scene, Integrator::chin4a, 10e-9), 3);
    const Chain chain(scene);
    EXPECT_NEAR(record.v_plate[1] / (0.1 * chain.inv_mass[6] * 1e-7), 1, 0.01);
    EXPECT_EQ(record.v_plate[0], 0);
}

TEST(Preload, AFreeEndFeelsThePreloadAsAConstantForce) {
    // without a horn's motion nothing happens; thrown off the horn, the chain is pushed back by F0
    Scene scene;
    scene.end.kind = EndKind::free;
    scene.chain.spheres = 1;
    scene.chain.damping_kg_per_s = 0;
    scene.drive.cycles = 1;
    const Record record = recorded(with_step(scene, Integrator::chin4a, 10e-9), 400);
    const Chain chain(scene);
    int flights = 0;
    for (std::size_t i = 1; i + 1 < 400; ++i) {
        const double overlap_if_horn_rests = chain.static_overlap[0] - record.chain_x[i];
        if (overlap_if_horn_rests < -4e-6) {  // beyond the horn's reach
            const double force = (record.v_last[i + 1] - record.v_last[i - 1]) / 2e-7 / chain.inv_mass[0];
            EXPECT_NEAR(force, -0.1, 1e-6);
            ++flights;
        }
    }
    EXPECT_GT(flights, 10);
}

TEST(Repetition, TheChainSettlesIntoTheSameAnswerToEveryBurst) {
    // what rings on from one burst meets the next (6e-3 of it), but is the same for all later ones
    Scene scene;
    scene.drive.repetition_hz = 1000;
    const Record record = recorded(with_step(scene, Integrator::chin4a, 50e-9), 40000);
    const auto change = [&](std::size_t burst) {
        double difference = 0;
        double norm = 0;
        for (std::size_t i = 0; i < 10000; ++i) {
            difference +=
                std::pow(record.v_out[10000 * burst + i] - record.v_out[10000 * (burst - 1) + i], 2);
            norm += std::pow(record.v_out[i], 2);
        }
        return std::sqrt(difference / norm);
    };
    EXPECT_LT(change(1), 2e-2);
    EXPECT_LT(change(2), 1e-3);
    EXPECT_LT(change(3), 1e-3);
}

TEST(Envelope, EveryOneConvergesWithTheStep) {
    struct Case {
        Envelope envelope;
        double cycles;
        double frequency_hz;
    };
    for (const Case& c : {Case{Envelope::rectangular, 5, 73e3}, Case{Envelope::rectangular, 4.25, 73e3},
                          Case{Envelope::tukey, 5.3, 73e3}, Case{Envelope::hann, 1, 73e3}}) {
        for (const auto& [integrator, bound] :
             {std::pair{Integrator::chin4a, 2e-4}, {Integrator::leapfrog, 2e-3}}) {
            Scene scene;
            scene.drive.envelope = c.envelope;
            scene.drive.cycles = c.cycles;
            scene.drive.frequency_hz = c.frequency_hz;
            const Record fine = recorded(with_step(scene, Integrator::chin4a, 2.5e-9), 1500);
            const Record coarse = recorded(with_step(scene, integrator, 25e-9), 1500);
            double difference = 0;
            double norm = 0;
            for (std::size_t i = 0; i < 1500; ++i) {
                difference += std::pow(coarse.v_last[i] - fine.v_last[i], 2);
                norm += std::pow(fine.v_last[i], 2);
            }
            EXPECT_LT(std::sqrt(difference / norm), bound) << c.cycles << ' ' << static_cast<int>(c.envelope);
        }
    }
}

}  // namespace
}  // namespace hertzline::test
