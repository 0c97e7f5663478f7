// Measures the time saved by skipping work that a scene does not need: run times with and without, side by side.
//
//     bench_skipping [--json FILE]

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/support/arguments.hpp"
#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"

namespace {

using namespace hertzline;

/// A run to be repeated: a scene, the requested outputs, and a duration.
struct Job {
    Scene scene;
    SimulationOptions options;
    double simulated_s;
};

struct Comparison {
    std::string what;
    Job without;  ///< skips the work
    Job with;
};

Scene shipped(const char* name, const std::function<void(Scene&)>& change = {}) {
    Scene scene = parse_scene(find_shipped_scene(name)->text, name)->scene;
    if (change) {
        change(scene);
    }
    return resolve(scene).scene;
}

std::vector<Comparison> comparisons() {
    const Scene burst = shipped("paper-vitreous-carbon");
    const Scene stream = shipped("paper-stream");
    const auto at_step_of_burst = [&](const std::function<void(Scene&)>& change) {
        Scene scene = burst;
        change(scene);
        return scene;
    };
    const SimulationOptions outputs{.ledger = LedgerKeeping::off};
    const SimulationOptions nothing{.taps = {}, .ledger = LedgerKeeping::off};
    const SimulationOptions all{.taps = all_taps, .ledger = LedgerKeeping::off};
    const auto rests = [](Scene& s) { s.numerics.rest_tolerance = 1e-3; };
    const auto clamped = [](Scene& s) { s.chain.tension = Tension::clamped; };
    const auto wall = [](Scene& s) { s.end.kind = EndKind::wall; };
    const auto closed = [](Scene& s) { s.drive.amplitude_m = 2e-9; };
    return {
        {"samples of the outputs", {burst, nothing, 5e-4}, {burst, outputs, 5e-4}},
        {"velocities and displacements of all spheres", {burst, outputs, 5e-4}, {burst, all, 5e-4}},
        {"the energy's ledger", {burst, outputs, 5e-4}, {burst, {}, 5e-4}},
        {"a chain at rest between bursts (1e-3)",
         {shipped("paper-stream", rests), {}, 5e-3},
         {stream, {}, 5e-3}},
        {"the plate", {at_step_of_burst(wall), outputs, 5e-4}, {burst, outputs, 5e-4}},
        {"contacts without tension", {burst, outputs, 5e-4}, {at_step_of_burst(clamped), outputs, 5e-4}},
        {"contacts that switch", {at_step_of_burst(closed), outputs, 5e-4}, {burst, outputs, 5e-4}},
    };
}

class Run {
public:
    explicit Run(const Job& job)
        : job_(job), simulation_(job.scene, job.options), block_(simulation_.make_samples(1000)) {}

    /// Wall time of a run from rest [s].
    double operator()() {
        using Clock = std::chrono::steady_clock;
        const auto samples = static_cast<std::int64_t>(job_.simulated_s * job_.scene.output.sample_rate_hz);
        simulation_.reset();
        const auto begin = Clock::now();
        while (simulation_.next_sample() < samples) {
            if (simulation_.advance(block_, 1000) != Status::running) {
                throw std::runtime_error("bench_skipping: " + simulation_.failure());
            }
        }
        return std::chrono::duration<double>(Clock::now() - begin).count();
    }
    std::int64_t steps() const { return simulation_.steps(); }

private:
    Job job_;
    Simulation simulation_;
    Samples block_;
};

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    Json rows = Json::array();
    std::printf("%-46s %10s %10s %8s %9s %9s\n", "skipped work", "off/us", "on/us", "ratio", "pieces",
                "pieces");
    for (const Comparison& comparison : comparisons()) {
        Run without(comparison.without);
        Run with(comparison.with);
        double min_without = 1e9;
        double min_with = 1e9;
        for (int round = 0; round < 25; ++round) {  // in turn, so that load on the machine affects both alike
            min_without = std::min(min_without, without());
            min_with = std::min(min_with, with());
        }
        std::printf("%-46s %10.1f %10.1f %8.2f %9lld %9lld\n", comparison.what.c_str(), min_with * 1e6,
                    min_without * 1e6, min_with / min_without, static_cast<long long>(with.steps()),
                    static_cast<long long>(without.steps()));
        rows.push_back({{"what", comparison.what},
                        {"not_skipped_s", min_with},
                        {"skipped_s", min_without},
                        {"ratio", min_with / min_without}});
    }
    arguments.save(rows);
    return 0;
}
