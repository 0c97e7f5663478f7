// Finds the fastest integrator for each length of the chain and each accuracy. The default choice (core/step_choice) rests on
// these results.
//
//     bench_crossover [MOST_SPHERES]     default 3000
//
// The scene is the paper's chain until the burst's wave has reached its end. Times are processor times, the lowest of three:
// `setup` is the choice of the step, `run` the integration. * marks an integrator that misses the accuracy by its own estimate.

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/integrators/stability.hpp"
#include "core/scene/scene_words.hpp"
#include "core/step_choice/step_advice.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"

namespace {

using namespace hertzline;

constexpr std::array candidates{Integrator::leapfrog, Integrator::chin4a, Integrator::taylor8,
                                Integrator::taylor12};

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Scene scene_of(std::int64_t spheres, double accuracy) {
    Scene scene;
    scene.chain.spheres = spheres;
    scene.end.kind = EndKind::wall;
    scene.numerics.accuracy = accuracy;
    const Chain chain(scene);
    const double omega = fastest_frequency(chain, expected_overlaps(chain, scene.drive));
    const double burst_s = scene.drive.cycles / scene.drive.frequency_hz;
    scene.output.duration_s = burst_s + 2.5 / omega * static_cast<double>(spheres);
    return scene;
}

struct Cost {
    double setup_s;
    double run_s;
    bool kept;  ///< the estimate is within the accuracy
};

Cost cost(Scene scene, Integrator integrator) {
    scene.numerics.integrator = integrator;
    const double accuracy = *scene.numerics.accuracy;
    const double begin = processor_seconds();
    const Resolution resolved = resolve(scene);
    Cost result{processor_seconds() - begin, std::numeric_limits<double>::infinity(),
                resolved.estimate && resolved.estimate->error <= accuracy};
    const auto samples = static_cast<std::int64_t>(scene.output.duration_s * scene.output.sample_rate_hz);
    Simulation simulation(resolved.scene);
    for (int repetition = 0; repetition < 3; ++repetition) {
        simulation.reset();
        const double start = processor_seconds();
        if (simulation.skip(samples) != Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        result.run_s = std::min(result.run_s, processor_seconds() - start);
    }
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    const std::int64_t most = argc > 1 ? std::stoll(argv[1]) : 3000;
    std::printf("run (setup) [ms]\n%7s %8s", "spheres", "accuracy");
    for (const Integrator integrator : candidates) {
        std::printf(" %20s", std::string(word(integrator)).c_str());
    }
    std::printf("  %-9s %s\n", "fastest", "default");
    for (const std::int64_t spheres : {6, 14, 30, 60, 100, 300, 1000, 3000, 10'000, 30'000}) {
        if (spheres > most) {
            break;
        }
        for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
            const Scene scene = scene_of(spheres, accuracy);
            std::printf("%7lld %8.0e", static_cast<long long>(spheres), accuracy);
            Integrator fastest = candidates[0];
            double least = std::numeric_limits<double>::infinity();
            for (const Integrator integrator : candidates) {
                const Cost found = cost(scene, integrator);
                std::printf(" %10.2f (%6.0f)%c", found.run_s * 1e3, found.setup_s * 1e3,
                            found.kept ? ' ' : '*');
                std::fflush(stdout);
                if (found.kept && found.run_s < least) {
                    least = found.run_s;
                    fastest = integrator;
                }
            }
            std::printf("  %-9s %s\n", std::string(word(fastest)).c_str(),
                        std::string(word(integrator_choice(scene).integrator)).c_str());
        }
    }
    return 0;
}
