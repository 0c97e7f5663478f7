// Measures how much faster than real time a modal plate in water runs, beside the same device with a lumped plate.
//
//     bench_plates [BURSTS]     default 20
//
// Bursts follow each other at 1 kHz. Times are processor times, the lowest of five: `real time` is the time simulated over them. Of each
// row all runs take turns, so that a busy machine slows all of them. `pieces` are those of the series; `ns` is the time of one.

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/model/chain.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"

namespace {

using namespace hertzline;

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Case {
    const char* scene;
    const char* outputs;
    TapSet taps;
    LedgerKeeping ledger;
};

constexpr TapSet of_water = TapSet(Tap::v_last) | Tap::v_centre | Tap::v_face | Tap::p_axis;
constexpr std::array cases{
    Case{"paper-stream", "v_out", Tap::v_out, LedgerKeeping::on},
    Case{"wet-vitreous-carbon", "v_last", Tap::v_last, LedgerKeeping::on},
    Case{"wet-vitreous-carbon", "v_centre v_face", TapSet(Tap::v_centre) | Tap::v_face, LedgerKeeping::on},
    Case{"wet-vitreous-carbon", "with p_axis", of_water, LedgerKeeping::on},
    Case{"wet-vitreous-carbon", "no ledger", of_water, LedgerKeeping::off},
};

}  // namespace

int main(int argc, char** argv) {
    const int bursts = argc > 1 ? std::stoi(argv[1]) : 20;
    constexpr double repetition_hz = 1000;
    constexpr std::size_t block = 256;
    struct Run {
        std::unique_ptr<Simulation> simulation;
        Samples samples;
        double least_s = std::numeric_limits<double>::infinity();
    };
    std::vector<Run> runs;
    for (const Case& one : cases) {
        Scene scene = read_scene(one.scene);
        scene.drive.repetition_hz = repetition_hz;
        scene.output.duration_s = bursts / repetition_hz;
        auto simulation = std::make_unique<Simulation>(
            resolve(scene), SimulationOptions{.taps = one.taps, .ledger = one.ledger});
        Samples samples = simulation->make_samples(block);
        runs.push_back({std::move(simulation), std::move(samples)});
    }
    const double sample_rate_hz = 10e6;
    const auto blocks = static_cast<int>(bursts / repetition_hz * sample_rate_hz / block);
    for (int repetition = 0; repetition < 5; ++repetition) {
        for (Run& run : runs) {
            run.simulation->reset();
            const double start = processor_seconds();
            for (int i = 0; i < blocks; ++i) {
                if (run.simulation->advance(run.samples, block) != Status::running) {
                    throw std::runtime_error(run.simulation->failure());
                }
            }
            run.least_s = std::min(run.least_s, processor_seconds() - start);
        }
    }
    std::printf("%-22s %-18s %10s %8s %6s %18s\n", "scene", "outputs", "real time", "pieces", "ns",
                "of paper-stream");
    const double simulated_s = blocks * static_cast<double>(block) / sample_rate_hz;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const auto pieces = static_cast<double>(runs[i].simulation->state().step);
        std::printf("%-22s %-18s %10.2f %8.0f %6.0f %18.2f\n", cases[i].scene, cases[i].outputs,
                    simulated_s / runs[i].least_s, pieces, 1e9 * runs[i].least_s / pieces,
                    runs[0].least_s / runs[i].least_s);
    }
    return 0;
}
