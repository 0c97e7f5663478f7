// Measures what different spheres, weights, a holder and other drives cost: time per step beside a uniform chain of as many spheres with
// a tone, by turns.
//
//     bench_mixed_chains [--json FILE]
//
// "lists" gives the uniform chain's own material and diameter as lists: the same motion, bit for bit. "record" is the tone's own motion as a
// record of 10 MS/s; "resonator" is for series alone.

#include <array>
#include <cstdio>
#include <functional>
#include <string>

#include "bench/support/arguments.hpp"
#include "bench/support/timing.hpp"
#include "core/integrators/kernels.hpp"
#include "core/model/horn.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/resolve.hpp"

namespace {

using namespace hertzline;

struct Variant {
    std::string name;
    std::function<void(Scene&)> change;
};

void record(Scene& scene) {
    Drive& drive = scene.drive;
    constexpr double rate = 10e6;
    const auto horn = make_horn(drive, 1 / rate);
    for (std::int64_t i = 0; static_cast<double>(i) / rate < 1.1 * drive.cycles / drive.frequency_hz; ++i) {
        drive.samples.push_back(horn->at(i, 0).x);
    }
    drive.kind = DriveKind::file;
    drive.sample_rate_hz = rate;
}

const std::array variants{
    Variant{"uniform", [](Scene&) {}},
    Variant{"lists",
            [](Scene& scene) {
                Spheres& chain = scene.chain;
                chain.materials = {chain.material, chain.material};
                chain.diameters_m = {chain.diameter_m};
            }},
    Variant{"steel and aluminium",
            [](Scene& scene) {
                scene.chain.materials = {"steel", "aluminium"};
            }},
    Variant{"taper", [](Scene& scene) { scene.chain.taper = 1e-4; }},
    Variant{"weight", [](Scene& scene) { scene.chain.gravity_m_per_s2 = 9.81; }},
    Variant{"holder", [](Scene& scene) { scene.chain.holder_time_s = 1e-3; }},
    Variant{"sweep", [](Scene& scene) { scene.drive.sweep_to_hz = 80e3; }},
    Variant{"record", record},
    Variant{"resonator",
            [](Scene& scene) {
                scene.drive.horn = HornModel::resonator;
                scene.drive.horn_mass_kg = 1e-3;
            }},
};

Scene scene_of(const Variant& variant, Integrator integrator, std::int64_t spheres) {
    Scene scene;
    scene.chain.spheres = spheres;
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = is_series(integrator) ? 0.4e-6 : 25e-9;
    scene.output.duration_s = spheres > 100 ? 100e-6 : 1e-3;
    variant.change(scene);
    return scene;
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    Json rows = Json::array();
    std::printf("%s\n%-10s %8s %-20s %10s %14s %12s\n", kernels::kernel_target(), "method", "spheres",
                "chain", "ns/step", "over uniform", "steps over");
    for (const Integrator integrator : choices<Integrator>) {
        for (const std::int64_t spheres : {6, 1000}) {
            double uniform = 0;
            double steps = 0;
            for (const Variant& variant : variants) {
                const Scene scene = scene_of(variant, integrator, spheres);
                if (scene.drive.horn == HornModel::resonator && !is_series(integrator)) {
                    continue;
                }
                const auto samples =
                    static_cast<std::int64_t>(scene.output.duration_s * scene.output.sample_rate_hz) + 1;
                const bench::Timing timing = bench::time_run(scene, samples);
                const double per_step = timing.median_s / static_cast<double>(timing.steps) * 1e9;
                uniform = &variant == variants.data() ? per_step : uniform;
                steps = &variant == variants.data() ? static_cast<double>(timing.steps) : steps;
                std::printf("%-10s %8lld %-20s %10.1f %14.2f %12.3f\n", std::string(word(integrator)).c_str(),
                            static_cast<long long>(spheres), variant.name.c_str(), per_step,
                            per_step / uniform, static_cast<double>(timing.steps) / steps);
                rows.push_back({{"integrator", word(integrator)},
                                {"spheres", spheres},
                                {"chain", variant.name},
                                {"ns_per_step", per_step},
                                {"over_uniform", per_step / uniform},
                                {"steps_over_uniform", static_cast<double>(timing.steps) / steps}});
            }
        }
    }
    arguments.save({{"simd", kernels::kernel_target()}, {"chains", rows}});
    return 0;
}
