// Measures each shipped scene at its default settings on one core: time per step and per sphere-step, real-time
// factor, and the error where a reference exists.
//
//     bench_scenes [--json FILE]

#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "bench/support/arguments.hpp"
#include "bench/support/timing.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/reference.hpp"

namespace {

using namespace hertzline;

/// Returns the reference of a shipped scene. The first burst of the streams is the vitreous-carbon scene's.
const std::map<std::string, std::string, std::less<>> references{
    {"paper-vitreous-carbon", "paper_vitreous_carbon"},
    {"paper-aluminium", "paper_aluminium"},
    {"paper-pyrex", "paper_pyrex"},
    {"paper-acrylic", "paper_acrylic"},
    {"paper-silicone-rubber", "paper_silicone_rubber"},
    {"paper-wall", "paper_wall"},
    {"paper-stream", "paper_vitreous_carbon"},
    {"paper-stream-symplectic", "paper_vitreous_carbon"},
    {"sonic-vacuum", "sonic_vacuum_10"},
};

double largest_error(std::string_view name, const Scene& scene) {
    const auto reference = references.find(name);
    if (reference == references.end()) {
        return NAN;
    }
    const test::Comparison errors =
        test::compare_with_reference(scene, test::read_reference(reference->second));
    return std::max({errors.v_last, errors.v_plate, errors.v_out});
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    Json rows = Json::array();
    std::printf("%s\n%-24s %-9s %8s %8s %10s %14s %10s %7s %10s\n", kernels::kernel_target(), "scene",
                "method", "spheres", "step/ns", "ns/step", "ns/sphere-step", "real-time", "spread", "error");
    for (const ShippedScene& shipped : shipped_scenes()) {
        const Scene scene = resolve(parse_scene(shipped.text, shipped.name)->scene).scene;
        const double rate = scene.output.sample_rate_hz;
        const auto samples = static_cast<std::int64_t>(scene.output.duration_s * rate) + 1;
        const bench::Timing timing = bench::time_run(scene, samples);
        const double per_step = timing.median_s / static_cast<double>(timing.steps) * 1e9;
        const double factor = static_cast<double>(samples) / rate / timing.median_s;
        const auto spheres = static_cast<double>(scene.chain.spheres);
        const double error = largest_error(shipped.name, scene);
        const std::string method(word(*scene.numerics.integrator));
        std::printf("%-24s %-9s %8lld %8.2f %10.1f %14.3f %10.3f %6.0f%% %10.2g\n",
                    std::string(shipped.name).c_str(), method.c_str(),
                    static_cast<long long>(scene.chain.spheres), *scene.numerics.step_s * 1e9, per_step,
                    per_step / spheres, factor, 100 * timing.spread, error);
        rows.push_back({{"scene", shipped.name},
                        {"integrator", method},
                        {"spheres", scene.chain.spheres},
                        {"step_s", *scene.numerics.step_s},
                        {"ns_per_step", per_step},
                        {"ns_per_sphere_step", per_step / spheres},
                        {"real_time_factor", factor},
                        {"spread", timing.spread},
                        {"error", error}});
    }
    arguments.save({{"simd", kernels::kernel_target()}, {"scenes", rows}});
    return 0;
}
