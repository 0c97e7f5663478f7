// Every SIMD target and every layout of the chain against a textbook implementation, and against each other.

#include "core/integrators/kernels.hpp"

#include <array>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/simd/target_choice.hpp"
#include "tests/support/bare_chain.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/textbook.hpp"

namespace hertzline::test {
namespace {

constexpr double common_step_s = 50e-9;
constexpr std::size_t steps = 700;  // a burst of 27 us and ringing after it
constexpr std::array<std::int64_t, 18> lengths{1,  2,  5,  6,  7,  13, 14, 15,  16,
                                               29, 30, 31, 61, 62, 63, 64, 100, 300};

/// Selects the kernels of one target during its lifetime.
class OnlyTarget {
public:
    explicit OnlyTarget(const std::string& target) { kernels::pin_kernel_target(target); }
    ~OnlyTarget() { kernels::pin_kernel_target(kernels::kernel_targets().front()); }
    OnlyTarget(const OnlyTarget&) = delete;
    OnlyTarget& operator=(const OnlyTarget&) = delete;
};

Scene short_burst(Integrator integrator, std::int64_t spheres) {
    Scene scene = with_step(Scene{}, integrator, common_step_s);
    scene.drive.cycles = 2;
    scene.chain.spheres = spheres;
    scene.output.sample_rate_hz = 1 / common_step_s;
    return scene;
}

struct Variant {
    std::string name;
    Scene scene;
};

std::vector<Variant> variants(Integrator integrator, std::int64_t spheres) {
    const Scene scene = short_burst(integrator, spheres);
    std::vector<Variant> variants{{"plate", scene},      {"wall", scene},    {"free end", scene},
                                  {"as printed", scene}, {"clamped", scene}, {"no preload", scene},
                                  {"mixed", scene},      {"held", scene},    {"struck", scene}};
    variants[1].scene.end.kind = EndKind::wall;
    variants[2].scene.end.kind = EndKind::free;
    variants[3].scene.end.preload = PlatePreload::as_printed;
    variants[4].scene.chain.tension = Tension::clamped;
    variants[5].scene.chain.preload_n = 0;
    Spheres& mixed = variants[6].scene.chain;
    mixed.materials = {"steel", "aluminium", "pyrex"};
    mixed.diameters_m = {1e-3, 0.7e-3};
    mixed.taper = 1e-4;
    mixed.gravity_m_per_s2 = 1000;
    variants[7].scene.chain.holder_time_s = 20e-6;
    variants[7].scene.chain.gravity_m_per_s2 = -0.5;
    Scene& struck = variants[8].scene;
    struck.drive.kind = DriveKind::none;
    struck.end.kind = EndKind::free;
    struck.chain.impact_velocity_m_per_s = 0.5;
    struck.chain.impact_spheres = std::min<std::int64_t>(2, spheres);
    return variants;
}

/// Returns the largest difference of a velocity, relative to the largest velocity.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    double scale = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = std::abs(a[i] - b[i]);
        if (std::isnan(d)) {
            return d;
        }
        largest = std::max(largest, d);
        scale = std::max(scale, std::abs(b[i]));
    }
    return largest / scale;
}

/// Returns the velocities of all spheres, [sample][sphere].
std::vector<double> textbook_velocities(const Scene& scene) {
    Textbook textbook(scene, common_step_s);
    const auto spheres = static_cast<std::ptrdiff_t>(scene.chain.spheres);
    std::vector<double> velocities;
    for (std::size_t i = 0; i <= steps; ++i) {
        velocities.insert(velocities.end(), textbook.v.begin(), textbook.v.begin() + spheres);
        textbook.step();
    }
    return velocities;
}

TEST(Kernels, LeapfrogDoesWhatTheTextbookSaysOnEveryTargetForEveryLayout) {
    for (const std::int64_t spheres : lengths) {
        for (const auto& [variant, scene] : variants(Integrator::leapfrog, spheres)) {
            const std::vector<double> expected = textbook_velocities(scene);
            for (const std::string& target : kernels::kernel_targets()) {
                const OnlyTarget only(target);
                EXPECT_LE(difference(recorded(scene, steps + 1).chain_v, expected), 5e-14)
                    << kernels::kernel_target() << ", " << spheres << " spheres, " << variant;
            }
        }
    }
}

class LocatingKernels : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, LocatingKernels, ::testing::ValuesIn(locating_integrators()),
                         integrator_name);

TEST_P(LocatingKernels, DoTheSameOnEveryTargetForEveryLayout) {
    const auto some =
        sanitized ? std::vector<std::int64_t>{1, 6, 15, 64} : std::vector(lengths.begin(), lengths.end());
    for (const std::int64_t spheres : some) {
        for (const auto& [variant, scene] : variants(GetParam(), spheres)) {
            const std::vector<double> expected = recorded(scene, steps + 1).chain_v;
            // without preload all contacts ahead of the wave just touch, and which of them rounding opens differs
            const double bound = variant == "no preload" ? 5e-8 : variant == "struck" ? 2e-13 : 5e-14;
            for (const std::string& target : kernels::kernel_targets()) {
                const OnlyTarget only(target);
                EXPECT_LE(difference(recorded(scene, steps + 1).chain_v, expected), bound)
                    << kernels::kernel_target() << ", " << spheres << " spheres, " << variant;
            }
        }
    }
}

TEST_P(LocatingKernels, ComeToWhatTheTextbookConvergesTo) {
    for (const std::int64_t spheres : {1, 6, 20, 80}) {
        for (const auto& [variant, scene] : variants(GetParam(), spheres)) {
            constexpr int finer = 64;
            Textbook textbook(scene, common_step_s / finer);
            std::vector<double> expected;
            for (std::size_t i = 0; i <= steps; ++i) {
                expected.insert(expected.end(), textbook.v.begin(), textbook.v.begin() + spheres);
                for (int k = 0; k < finer; ++k) {
                    textbook.step();
                }
            }
            EXPECT_LE(difference(recorded(scene, steps + 1).chain_v, expected), 2e-5)
                << spheres << " spheres, " << variant;
        }
    }
}

TEST(Kernels, OneMoreBodyThanARegisterHoldsChangesNothingForTheOthers) {
    // long before the end is reached, chains of any length move alike; layouts of 1, 2, 4, 8 and more rows
    for (const Integrator integrator : choices<Integrator>) {
        const auto first_sphere = [&](std::int64_t spheres) {
            const Record record = recorded(short_burst(integrator, spheres), 60);
            std::vector<double> velocities;
            for (std::size_t i = 0; i < 60; ++i) {
                velocities.push_back(record.chain_v[i * static_cast<std::size_t>(spheres)]);
            }
            return velocities;
        };
        const std::vector<double> expected = first_sphere(3000);
        for (const std::int64_t spheres : {29, 30, 31, 61, 62, 63, 64, 100, 300}) {
            EXPECT_LE(difference(first_sphere(spheres), expected), 1e-13) << spheres;
        }
    }
}

TEST(Kernels, AWaveThatRunsIntoSpheresAtRestMovesThemAsTheTextbookSays) {
    // 600 spheres are laid out by and by, as the wave advances; the textbook works on all of them from the start
    for (const Integrator integrator : choices<Integrator>) {
        Scene scene = short_burst(integrator, 600);
        scene.chain.damping_kg_per_s = 0.01;
        scene.chain.preload_n = 10;
        scene.drive.amplitude_m = 1e-7;
        constexpr int finer = 16;
        const bool same_method = integrator == Integrator::leapfrog;
        Textbook textbook(scene, same_method ? common_step_s : common_step_s / finer);
        std::vector<double> expected;
        for (std::size_t i = 0; i < 3000; ++i) {
            expected.insert(expected.end(), textbook.v.begin(), textbook.v.begin() + 600);
            for (int k = 0; k < (same_method ? 1 : finer); ++k) {
                textbook.step();
            }
        }
        EXPECT_LE(difference(recorded(scene, 3000).chain_v, expected), same_method ? 2e-12 : 1e-4);
    }
}

TEST(Kernels, AMovingChainOfManyTilesComesToTheSameBitsHoweverItsStepsAreGrouped) {
    const Scene scene = short_burst(Integrator::leapfrog, 3000);
    for (const std::string& target : kernels::kernel_targets()) {
        const OnlyTarget only(target);
        BareChain together(scene);
        std::mt19937 random(1);
        for (double& v : together.state.v.head(together.chain.spheres())) {
            v = std::uniform_real_distribution<double>(-0.5, 0.5)(random);
        }
        BareChain one_by_one(scene);
        one_by_one.state = together.state;
        together.advance(100);
        for (int step = 0; step < 100; ++step) {
            one_by_one.advance(1);
        }
        EXPECT_TRUE((together.state.x == one_by_one.state.x).all()) << kernels::kernel_target();
        EXPECT_TRUE((together.state.v == one_by_one.state.v).all()) << kernels::kernel_target();
        EXPECT_TRUE((together.state.peak_overlap == one_by_one.state.peak_overlap).all())
            << kernels::kernel_target();
        EXPECT_NEAR(together.lost / one_by_one.lost, 1, 1e-12) << kernels::kernel_target();
    }
}

TEST(Kernels, SkippingSpheresAtRestChangesNoBitOnAnyTarget) {
    for (const std::int64_t spheres : {16, 33, 64, 700}) {
        for (const auto& [variant, scene] : variants(Integrator::leapfrog, spheres)) {
            for (const std::string& target : kernels::kernel_targets()) {
                const OnlyTarget only(target);
                Simulation skipping(scene, {.taps = everything, .tracking = WavefrontTracking::on});
                Simulation working(scene, {.taps = everything, .tracking = WavefrontTracking::off});
                const auto what = [&, &variant = variant] {
                    return std::string(kernels::kernel_target()) + ", " + std::to_string(spheres) +
                           " spheres, " + variant;
                };
                EXPECT_EQ(recorded(skipping, 500, 100), recorded(working, 500, 100)) << what();
                EXPECT_EQ(skipping.contact_events(), working.contact_events()) << what();
                EXPECT_EQ(skipping.energy_residual(), working.energy_residual()) << what();
            }
        }
    }
}

TEST(Kernels, SeriesLeaveSpheresAtRestOutAndTheRestMovesAsItWould) {
    for (const Integrator integrator : {Integrator::taylor8, Integrator::taylor12}) {
        for (const std::int64_t spheres : {63, 64, 90, 700}) {
            for (const auto& [variant, scene] : variants(integrator, spheres)) {
                Simulation skipping(scene, {.taps = everything, .tracking = WavefrontTracking::on});
                Simulation working(scene, {.taps = everything, .tracking = WavefrontTracking::off});
                const std::string what = std::to_string(spheres) + " spheres, " + variant;
                const Record left_out = recorded(skipping, 600, 100);
                const Record all = recorded(working, 600, 100);
                EXPECT_LE(difference(left_out.chain_v, all.chain_v), 1e-18) << what;
                EXPECT_LE(difference(left_out.chain_x, all.chain_x), 1e-18) << what;
                // without preload all contacts ahead of the wave just touch, and rounding opens and closes them
                if (variant != "no preload") {
                    EXPECT_EQ(skipping.contact_events(), working.contact_events()) << what;
                }
            }
        }
    }
}

TEST(Kernels, SpheresAheadOfTheWaveAreLeftOutWithoutATrace) {
    // An unbalanced plate has the whole chain worked on from the start; before a wall it is laid out by and by.
    // Bodies that neither end can have reached from the other agree to the last bit, down to the faintest
    // forerunner of the wave.
    for (const Integrator integrator : choices<Integrator>) {
        Scene scene = short_burst(integrator, 10'000);
        scene.end.kind = EndKind::wall;
        Simulation by_and_by(scene);
        scene.end.kind = EndKind::plate;
        scene.end.preload = PlatePreload::as_printed;
        Simulation at_once(scene);
        EXPECT_EQ(by_and_by.skip(200), Status::running);
        EXPECT_EQ(at_once.skip(200), Status::running);
        const Eigen::ArrayXd expected = at_once.state().v.head(3000);
        EXPECT_GT((expected != 0).count(), 100);
        // a series takes motion far below rounding for rest
        const double tolerated = is_series(integrator) ? 1e-18 * expected.abs().maxCoeff() : 0;
        EXPECT_LE((by_and_by.state().v.head(3000) - expected).abs().maxCoeff(), tolerated);
        const auto moving = [](Simulation& simulation) { return (simulation.state().v != 0).count(); };
        EXPECT_LE(moving(by_and_by), moving(at_once));
    }
}

}  // namespace
}  // namespace hertzline::test
