// Measures what different spheres, weights and a holder cost: time per step beside a uniform chain of as many spheres, by turns.
//
//     bench_mixed_chains [--json FILE]
//
// "lists" gives the uniform chain's own material and diameter as lists: the same motion, bit for bit.

#include <array>
#include <cstdio>
#include <functional>
#include <string>

#include "bench/support/arguments.hpp"
#include "bench/support/timing.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/resolve.hpp"

namespace {

using namespace hertzline;

struct Variant {
    std::string name;
    std::function<void(Spheres&)> change;
};

const std::array variants{
    Variant{"uniform", [](Spheres&) {}},
    Variant{"lists",
            [](Spheres& chain) {
                chain.materials = {chain.material, chain.material};
                chain.diameters_m = {chain.diameter_m};
            }},
    Variant{"steel and aluminium",
            [](Spheres& chain) {
                chain.materials = {"steel", "aluminium"};
            }},
    Variant{"taper", [](Spheres& chain) { chain.taper = 1e-4; }},
    Variant{"weight", [](Spheres& chain) { chain.gravity_m_per_s2 = 9.81; }},
    Variant{"holder", [](Spheres& chain) { chain.holder_time_s = 1e-3; }},
};

Scene scene_of(const Variant& variant, Integrator integrator, std::int64_t spheres) {
    Scene scene;
    scene.chain.spheres = spheres;
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = is_series(integrator) ? 0.4e-6 : 25e-9;
    scene.output.duration_s = spheres > 100 ? 100e-6 : 1e-3;
    variant.change(scene.chain);
    return scene;
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    Json rows = Json::array();
    std::printf("%s\n%-10s %8s %-20s %10s %14s\n", kernels::kernel_target(), "method", "spheres", "chain",
                "ns/step", "over uniform");
    for (const Integrator integrator : choices<Integrator>) {
        for (const std::int64_t spheres : {6, 1000}) {
            double uniform = 0;
            for (const Variant& variant : variants) {
                const Scene scene = scene_of(variant, integrator, spheres);
                const auto samples =
                    static_cast<std::int64_t>(scene.output.duration_s * scene.output.sample_rate_hz) + 1;
                const bench::Timing timing = bench::time_run(scene, samples);
                const double per_step = timing.median_s / static_cast<double>(timing.steps) * 1e9;
                uniform = &variant == variants.data() ? per_step : uniform;
                std::printf("%-10s %8lld %-20s %10.1f %14.2f\n", std::string(word(integrator)).c_str(),
                            static_cast<long long>(spheres), variant.name.c_str(), per_step,
                            per_step / uniform);
                rows.push_back({{"integrator", word(integrator)},
                                {"spheres", spheres},
                                {"chain", variant.name},
                                {"ns_per_step", per_step},
                                {"over_uniform", per_step / uniform}});
            }
        }
    }
    arguments.save({{"simd", kernels::kernel_target()}, {"chains", rows}});
    return 0;
}
