#pragma once
// Times a run: one warm-up, repetitions from the same state, median and spread.

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <vector>

#include "hertzline/simulation.hpp"

namespace hertzline::bench {

struct Timing {
    double median_s = 0;
    double spread = 0;  ///< (slowest - fastest) / median
    std::int64_t steps = 0;
};

/// Runs `samples` samples of the outputs from sample 0, `repetitions` times after one unmeasured run.
inline Timing time_run(const Scene& resolved, std::int64_t samples, int repetitions = 9) {
    using Clock = std::chrono::steady_clock;
    constexpr std::size_t block = 1024;
    Simulation simulation(resolved);
    Samples part = simulation.make_samples(block);
    std::vector<double> times;
    for (int run = 0; run <= repetitions; ++run) {
        simulation.reset();
        const auto begin = Clock::now();
        while (simulation.next_sample() < samples) {
            const std::int64_t left = samples - simulation.next_sample();
            if (simulation.advance(part, static_cast<std::size_t>(std::min<std::int64_t>(block, left))) !=
                Status::running) {
                throw std::runtime_error(simulation.failure());
            }
        }
        if (run > 0) {
            times.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
        }
    }
    std::ranges::sort(times);
    const double median = times[times.size() / 2];
    return {median, (times.back() - times.front()) / median, simulation.steps()};
}

}  // namespace hertzline::bench
