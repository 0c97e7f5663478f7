// Measures long chains on one core: the time of a sphere-step when all spheres move, and the time of spheres at rest.
//
//     bench_long_chain              the table
//     bench_long_chain SPHERES      SPHERES and ns per sphere-step, all moving
//     bench_long_chain pulse SPHERES STEPS DAMPING
//                                   number and velocity [m/s] of each sphere after the first was kicked,
//                                   touching ones without preload; for lammps/compare.py
//
// Times are processor times, so that other load on the machine matters less; each is the lowest of many.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "hertzline/simulation.hpp"
#include "tests/support/bare_chain.hpp"

namespace {

using namespace hertzline;

constexpr double step_s = 25e-9;

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Scene long_scene(std::int64_t spheres) {
    Scene scene;
    scene.chain.spheres = spheres;
    scene.end.kind = EndKind::wall;
    scene.numerics.integrator = Integrator::leapfrog;
    scene.numerics.step_s = step_s;
    scene.output.sample_rate_hz = 1 / step_s;
    return scene;
}

/// Returns seconds per step with spheres at random velocities up to 0.1 m/s: contacts open and close all along the chain.
double all_moving(std::int64_t spheres) {
    const Scene scene = long_scene(spheres);
    const Chain chain(scene);
    ChainState state(chain);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> velocity(-0.1, 0.1);
    for (double& v : state.v.head(chain.spheres())) {
        v = velocity(random);
    }
    const ToneBurst burst(scene.drive, step_s);
    kernels::SimdChain folded(chain, Integrator::leapfrog, kernels::kernel_lanes());
    folded.step_s = step_s;
    folded.watched_overlap = std::numeric_limits<double>::infinity();
    folded.load(chain, state, chain.bodies());
    const kernels::Kernel advance = kernels::kernel(Integrator::leapfrog, folded.rows());
    kernels::Trace nothing;
    nothing.bodies = chain.bodies();
    nothing.capacity = kernels::max_rows_per_step;
    std::vector<HornStep> horn(ToneBurst::batch_steps);
    const auto batches = static_cast<int>(std::clamp<std::int64_t>(20'000'000 / 64 / spheres, 1, 100));
    double least = std::numeric_limits<double>::infinity();
    for (int repetition = 0; repetition < 12; ++repetition) {
        folded.load(chain, state, chain.bodies());
        advance(folded, burst, horn.data(), 0, ToneBurst::batch_steps, nothing);
        const double begin = processor_seconds();
        for (int batch = 1; batch <= batches; ++batch) {
            advance(folded, burst, horn.data(), batch * ToneBurst::batch_steps, ToneBurst::batch_steps,
                    nothing);
        }
        least = std::min(least, processor_seconds() - begin);
    }
    folded.store(state);
    if (!state.x.allFinite() || (state.v.head(chain.spheres()) == 0).any()) {
        throw std::runtime_error("not all spheres move");
    }
    return least / (batches * ToneBurst::batch_steps);
}

/// Returns seconds per step while the horn's wave is on the first 1000 spheres, and the number of moving spheres.
struct Wave {
    double step_s;
    std::int64_t moving;
};
Wave wave(std::int64_t spheres, WavefrontTracking tracking, std::int64_t from, std::int64_t steps) {
    Simulation simulation(long_scene(spheres), {.tracking = tracking});
    Wave result{std::numeric_limits<double>::infinity(), 0};
    for (int repetition = 0; repetition < 12; ++repetition) {
        simulation.reset();
        static_cast<void>(simulation.skip(from));
        const double begin = processor_seconds();
        if (simulation.skip(steps) != Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        result.step_s = std::min(result.step_s, (processor_seconds() - begin) / static_cast<double>(steps));
    }
    result.moving = (simulation.state().v != 0).count();
    return result;
}

void print_table() {
    std::printf("%s, one core\n\n%9s %18s\n", kernels::kernel_target(), "spheres", "ns/sphere-step");
    double at_10000 = 0;
    for (const std::int64_t spheres : {1000, 10'000, 100'000, 1'000'000}) {
        const double per_sphere = all_moving(spheres) * 1e9 / static_cast<double>(spheres);
        at_10000 = spheres == 10'000 ? per_sphere : at_10000;
        std::printf("%9lld %18.3f\n", static_cast<long long>(spheres), per_sphere);
        if (spheres == 1'000'000) {
            std::printf("1e6 over 1e4: %.2f\n", per_sphere / at_10000);
        }
    }
    constexpr std::int64_t from = 22'400;
    constexpr std::int64_t steps = 640;
    const Wave is_short = wave(1000, WavefrontTracking::off, from, steps);
    const Wave skipping = wave(100'000, WavefrontTracking::on, from, steps);
    const Wave not_skipping = wave(100'000, WavefrontTracking::off, from, steps / 10);
    std::printf("\n%-46s %9s %9s\n", "the horn's wave", "us/step", "moving");
    const auto line = [](const char* name, const Wave& w) {
        std::printf("%-46s %9.3f %9lld\n", name, w.step_s * 1e6, static_cast<long long>(w.moving));
    };
    line("1000 spheres", is_short);
    line("100 000 spheres, those at rest skipped", skipping);
    line("100 000 spheres, all worked on", not_skipping);
    std::printf("100 000 over 1000: %.2f with skipping, %.0f without\n", skipping.step_s / is_short.step_s,
                not_skipping.step_s / is_short.step_s);
}

void print_pulse(std::int64_t spheres, std::int64_t steps, double damping) {
    Scene scene = long_scene(spheres);
    scene.chain.preload_n = 0;
    scene.chain.damping_kg_per_s = damping;
    test::BareChain bare(scene);
    bare.state.v[0] = 0.5;
    bare.advance(steps);
    for (Eigen::Index b = 0; b < bare.chain.spheres(); ++b) {
        std::printf("%lld %.10g\n", static_cast<long long>(b + 1), bare.state.v[b]);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 5 && std::string(argv[1]) == "pulse") {
        print_pulse(std::stoll(argv[2]), std::stoll(argv[3]), std::stod(argv[4]));
        return 0;
    }
    if (argc == 2) {
        const std::int64_t spheres = std::stoll(argv[1]);
        std::printf("%lld %.4f\n", static_cast<long long>(spheres),
                    all_moving(spheres) * 1e9 / static_cast<double>(spheres));
        return 0;
    }
    print_table();
    return 0;
}
