// Measures arrays of 1 to 256 chains on a hexagonal lattice of 12 mm: set-up, processor time for each simulated microsecond, memory.
// plot_arrays.py draws the results.
//
//     bench_arrays [--json FILE] [MOST]
//
// "alike": no coupling, all chains driven together, one simulated; "delayed": no coupling, each with a delay of its own; "fluid": coupled.
// Outputs are v_last of each element and the pressure at one point. Times are processor times, of one thread.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include <sys/resource.h>

#include "bench/support/arguments.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"

namespace {

using namespace hertzline;

double processor_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Memory of the process at its highest so far [MiB].
double peak_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Chains on a hexagonal lattice, the nearest to its middle first.
Scene lattice(std::size_t count) {
    constexpr double pitch_m = 12e-3;
    constexpr int reach = 12;
    std::vector<std::array<double, 2>> places;
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            places.push_back({pitch_m * (i + 0.5 * j), pitch_m * std::sqrt(0.75) * j});
        }
    }
    std::ranges::stable_sort(places, {},
                             [](const auto& p) { return std::round(1e9 * std::hypot(p[0], p[1])); });
    Scene scene;
    scene.end.model = PlateModel::modal;
    for (std::size_t i = 0; i < count; ++i) {
        scene.array.x_m.push_back(places[i][0]);
        scene.array.y_m.push_back(places[i][1]);
    }
    scene.output.points_m = {{0, 0, 60e-3}};
    scene.numerics.integrator = Integrator::taylor8;
    scene.numerics.step_s = 0.7e-6;
    scene.numerics.poles = 36;
    return scene;
}

/// Prints a row, and returns it.
Json measure(const char* drive, const Scene& scene) {
    const std::size_t elements = chains_of(scene);
    const double begin = processor_s();
    Simulation simulation(scene, {.taps = TapSet(Tap::v_last) | Tap::p_points});
    const double set_up_s = processor_s() - begin;
    const std::size_t samples = elements > 64 ? 500 : 2000;
    Samples block = simulation.make_samples(500);
    const double from = processor_s();
    for (std::size_t done = 0; done < samples; done += block.count) {
        if (simulation.advance(block, 500) != Status::running) {
            std::printf("%s\n", simulation.failure().c_str());
            return {};
        }
    }
    const double per_us = (processor_s() - from) / (0.1 * static_cast<double>(samples)) * 1e6;
    std::printf("%8zu  %-8s %9.3f %14.1f %14.2f %9.0f\n", elements, drive, set_up_s, per_us,
                per_us / static_cast<double>(elements), peak_mib());
    std::fflush(stdout);
    return {{"elements", elements},
            {"drive", drive},
            {"set_up_s", set_up_s},
            {"us_per_simulated_us", per_us},
            {"peak_mib", peak_mib()}};
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    const std::size_t most = arguments.words.empty() ? max_elements : std::stoul(arguments.words[0]);
    Json rows = Json::array();
    measure("warm-up", lattice(2));
    std::printf("elements  drive    set-up s  us per sim. us    per element  peak MiB\n");
    for (const std::size_t count : {1, 2, 4, 7, 19, 37, 64, 128, 256}) {
        if (count > most) {
            break;
        }
        Scene scene = lattice(count);
        scene.array.coupling = Coupling::none;
        rows.push_back(measure("alike", scene));
        for (std::size_t i = 0; i < count; ++i) {
            scene.array.delays_s.push_back(1e-8 * static_cast<double>(i));
        }
        rows.push_back(measure("delayed", scene));
        scene.array.coupling = Coupling::fluid;
        rows.push_back(measure("fluid", scene));
    }
    arguments.save({{"simd", kernels::kernel_target()}, {"arrays", rows}});
    return 0;
}
