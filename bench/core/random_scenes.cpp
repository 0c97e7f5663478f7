// Runs scenes drawn at random, and reports NaN, a stop without a reason, chattering contacts and unnoticed energy loss.
//
//     bench_random_scenes [--json FILE] [COUNT [SEED]]
//
// Scene number i has the seed SEED + i. `bench_random_scenes 1 SEED` prints and repeats a reported one.

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "bench/support/arguments.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/random_scene.hpp"
#include "tests/support/trial.hpp"

namespace {

using namespace hertzline;
using test::Outcome;
using test::Trial;
/// All trials of one integrator.
struct Tally {
    std::map<Outcome, int> outcomes;
    int broken = 0;
    double steps = 0;
    double max_crowded = 0;
    std::vector<double> residuals;  ///< of the scenes that ran

    void add(const Trial& trial) {
        ++outcomes[trial.outcome];
        broken += trial.findings.empty() ? 0 : 1;
        steps += static_cast<double>(trial.steps);
        max_crowded = std::max(max_crowded, trial.crowding);
        if (trial.outcome == Outcome::ran) {
            residuals.push_back(trial.residual);
        }
    }
    double residual(double quantile) {
        if (residuals.empty()) {
            return 0;
        }
        std::ranges::sort(residuals);
        return residuals[static_cast<std::size_t>(quantile * static_cast<double>(residuals.size() - 1))];
    }
};

void print_findings(std::uint64_t seed, const Trial& trial) {
    for (const std::string& finding : trial.findings) {
        std::printf("seed %llu, %s: %s\n", static_cast<unsigned long long>(seed),
                    std::string(word(trial.integrator)).c_str(), finding.c_str());
        std::fflush(stdout);
    }
}

Json print(std::map<Integrator, Tally>& tallies) {
    Json rows = Json::array();
    std::printf("\n%-9s %7s %7s %8s %7s %10s %9s %24s\n", "method", "ran", "stopped", "refused", "broken",
                "steps", "crowding", "residual: median, worst");
    for (auto& [integrator, tally] : tallies) {
        const std::string name(word(integrator));
        std::printf("%-9s %7d %7d %8d %7d %10.3g %9.2g %12.1e %11.1e\n", name.c_str(),
                    tally.outcomes[Outcome::ran], tally.outcomes[Outcome::stopped],
                    tally.outcomes[Outcome::refused], tally.broken, tally.steps, tally.max_crowded,
                    tally.residual(0.5), tally.residual(1));
        rows.push_back({{"integrator", name},
                        {"ran", tally.outcomes[Outcome::ran]},
                        {"stopped", tally.outcomes[Outcome::stopped]},
                        {"refused", tally.outcomes[Outcome::refused]},
                        {"broken", tally.broken},
                        {"steps", tally.steps},
                        {"max_crowded", tally.max_crowded},
                        {"median_residual", tally.residual(0.5)},
                        {"worst_residual", tally.residual(1)}});
    }
    return rows;
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    const auto& words = arguments.words;
    const std::uint64_t count = words.empty() ? 10'000 : std::stoull(words[0]);
    const std::uint64_t first = words.size() < 2 ? 1 : std::stoull(words[1]);
    std::map<Integrator, Tally> tallies;
    int broken = 0;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
        const Scene scene = test::random_scene(seed);
        if (!validate(scene).empty()) {
            std::printf("seed %llu: not a valid scene: %s\n", static_cast<unsigned long long>(seed),
                        validate(scene).front().key.c_str());
            return 1;
        }
        if (count == 1) {
            std::printf("%s\n", to_toml(scene).c_str());
        }
        const Trial trial = test::tried(scene);
        print_findings(seed, trial);
        broken += trial.findings.empty() ? 0 : 1;
        tallies[trial.integrator].add(trial);
        if (count == 1 && !trial.message.empty()) {
            std::printf("%s\n", trial.message.c_str());
        }
    }
    arguments.save(print(tallies));
    return broken == 0 ? 0 : 1;
}
