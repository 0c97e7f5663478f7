// Error against run time: each integrator over a range of steps, on scenes with a reference.
//
//     bench_work_precision [--json FILE] [REFERENCE...]      paper_vitreous_carbon and free_end by default

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include <nlohmann/json.hpp>

#include "tests/support/reference.hpp"

namespace {

using namespace hertzline;

nlohmann::ordered_json measure(const std::string& file, Integrator integrator, double step_s) {
    const test::Reference reference = test::read_reference(file);
    Scene scene = test::reference_scene(file);
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = step_s;
    const test::Comparison errors = test::compare_with_reference(scene, reference);
    const auto samples = static_cast<std::int64_t>(reference.v_last.size());
    const bench::Timing timing = bench::time_run(scene, samples, 5);
    const double factor = static_cast<double>(samples - 1) / scene.output.sample_rate_hz / timing.median_s;
    const double v_out = std::max(errors.v_plate, errors.v_out);
    const char* name = integrator == Integrator::chin4a ? "chin4a" : "leapfrog";
    std::printf("%-24s %-9s %8.1f %11.2g %11.2g %11.2g %10.2f\n", file.c_str(), name, step_s * 1e9,
                errors.v_last, v_out, errors.energy_residual, factor);
    return {{"scene", file},
            {"integrator", name},
            {"step_s", step_s},
            {"error_v_last", errors.v_last},
            {"error_v_out", v_out},
            {"energy_residual", errors.energy_residual},
            {"real_time_factor", factor}};
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> files(argv + 1, argv + argc);
    std::string json;
    if (files.size() >= 2 && files[0] == "--json") {
        json = files[1];
        files.erase(files.begin(), files.begin() + 2);
    }
    if (files.empty()) {
        files = {"paper_vitreous_carbon", "free_end"};
    }
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    std::printf("%s\n%-24s %-9s %8s %11s %11s %11s %10s\n", kernel_target(), "scene", "method", "step/ns",
                "error v_last", "error v_out", "energy", "real-time");
    for (const std::string& file : files) {
        for (const Integrator integrator : {Integrator::leapfrog, Integrator::chin4a}) {
            for (const double step_s : {400e-9, 200e-9, 100e-9, 50e-9, 25e-9, 12.5e-9, 6.25e-9}) {
                rows.push_back(measure(file, integrator, step_s));
            }
        }
    }
    if (!json.empty()) {
        std::ofstream(json) << rows.dump(2) << '\n';
    }
    return 0;
}
