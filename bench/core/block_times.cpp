// Measures the time to simulate one block of a stream, and the ratio of the worst block to the median. Series take longer
// where contacts open and close; a fixed step does not.
//
//     bench_block_times [--json FILE] [PERIODS]      of 1 ms, 100 by default
//
// Each block is simulated in several runs, and its shortest time counts, so that other load on the machine is left out.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/support/arguments.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"

namespace {

using namespace hertzline;

constexpr std::array scenes{"paper-stream", "paper-stream-symplectic"};
constexpr std::size_t block_samples = 1024;
constexpr int runs = 15;
/// Upper ends of the histogram's classes, in medians.
constexpr std::array classes{0.5, 0.8, 1.0, 1.25, 1.5, 2.0, 3.0, 5.0};

/// Returns the shortest time of each block [s].
std::vector<double> block_times(const Scene& scene, std::size_t blocks) {
    using Clock = std::chrono::steady_clock;
    Simulation simulation(scene);
    Samples block = simulation.make_samples(block_samples);
    std::vector<double> times(blocks, std::numeric_limits<double>::infinity());
    for (int run = 0; run < runs; ++run) {
        simulation.reset();
        for (double& shortest : times) {
            const auto begin = Clock::now();
            if (simulation.advance(block, block_samples) != Status::running) {
                throw std::runtime_error(simulation.failure());
            }
            shortest = std::min(shortest, std::chrono::duration<double>(Clock::now() - begin).count());
        }
    }
    return times;
}

Json report(const std::string& name, std::size_t periods) {
    const Scene scene = resolve(parse_scene(find_shipped_scene(name)->text, name)->scene).scene;
    const double block_s = block_samples / scene.output.sample_rate_hz;
    const auto blocks =
        static_cast<std::size_t>(static_cast<double>(periods) / scene.drive.repetition_hz / block_s);
    std::vector<double> times = block_times(scene, blocks);
    std::ranges::sort(times);
    const double median = times[times.size() / 2];
    std::printf("%-24s median %6.1f us of %.1f, worst %6.1f us = %.2f medians;", name.c_str(), median * 1e6,
                block_s * 1e6, times.back() * 1e6, times.back() / median);
    std::vector<double> shares;
    auto from = times.begin();
    for (const double end : classes) {
        const auto to = std::ranges::upper_bound(from, times.end(), end * median);
        shares.push_back(static_cast<double>(to - from) / static_cast<double>(times.size()));
        std::printf("  <=%.2f: %.0f %%", end, 100 * shares.back());
        from = to;
    }
    std::printf("\n");
    return {{"scene", name},
            {"blocks", blocks},
            {"median_s", median},
            {"worst_s", times.back()},
            {"worst_over_median", times.back() / median},
            {"classes", classes},
            {"shares", shares}};
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    const std::size_t periods = arguments.words.empty() ? 100 : std::stoul(arguments.words.front());
    Json rows = Json::array();
    std::printf("%s, blocks of %zu samples\n", kernels::kernel_target(), block_samples);
    for (const char* name : scenes) {
        rows.push_back(report(name, periods));
    }
    arguments.save({{"simd", kernels::kernel_target()}, {"block_samples", block_samples}, {"scenes", rows}});
    return 0;
}
