// Measures one step of leapfrog and of chin4a for chains of many lengths, with all spheres moving. "items" are sphere-steps.

#include <benchmark/benchmark.h>

#include "hertzline/simulation.hpp"

namespace {

using namespace hertzline;

/// Makes a chain in motion from end to end. The horn drives a short one until a wave has crossed it; in a long one an
/// end that starts out of balance excites the motion.
Scene moving(std::int64_t spheres, Integrator integrator) {
    Scene scene;
    scene.chain.spheres = spheres;
    scene.end.preload = PlatePreload::as_printed;
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = 25e-9;
    scene.output.sample_rate_hz = 1e6;
    return scene;
}

void step(benchmark::State& state, Integrator integrator) {
    const Scene scene = moving(state.range(0), integrator);
    Simulation simulation(scene);
    Samples part = simulation.make_samples(16);
    static_cast<void>(simulation.skip(20));
    std::int64_t steps = 0;
    for (auto _ : state) {
        const std::int64_t before = simulation.steps();
        if (simulation.advance(part, 16) != Status::running) {
            state.SkipWithError("unstable");
            break;
        }
        benchmark::DoNotOptimize(part[Tap::v_out].data());
        steps += simulation.steps() - before;
        if (simulation.next_sample() > 5000) {
            state.PauseTiming();
            simulation.reset();
            static_cast<void>(simulation.skip(20));
            state.ResumeTiming();
        }
    }
    state.SetItemsProcessed(steps * state.range(0));
}

BENCHMARK_CAPTURE(step, leapfrog, Integrator::leapfrog)
    ->Arg(1)
    ->Arg(6)
    ->Arg(14)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(100'000);
BENCHMARK_CAPTURE(step, chin4a, Integrator::chin4a)->Arg(1)->Arg(6)->Arg(14)->Arg(30)->Arg(100)->Arg(1000);

}  // namespace

BENCHMARK_MAIN();
