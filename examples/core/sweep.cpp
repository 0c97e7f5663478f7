// Runs a scene for several values of the preload and prints what each gives at the output. Nothing is written to a file.

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <iostream>
#include <stdexcept>

#include <hertzline/resolve.hpp>
#include <hertzline/simulation.hpp>

namespace {

/// Root mean square of v_out over the scene's duration [m/s].
double output_rms(const hertzline::Scene& scene) {
    hertzline::Simulation simulation(hertzline::resolve(scene), {.taps = hertzline::Tap::v_out});
    const auto samples =
        static_cast<std::size_t>(std::llround(scene.output.duration_s * scene.output.sample_rate_hz));
    // A short run fits into one block.
    hertzline::Samples block = simulation.make_samples(samples);
    if (simulation.advance(block, samples) != hertzline::Status::running) {
        throw std::runtime_error(simulation.failure());
    }
    double sum = 0;
    for (const double v : block[hertzline::Tap::v_out]) {
        sum += v * v;
    }
    return std::sqrt(sum / static_cast<double>(samples));
}

}  // namespace

int main() {
    try {
        std::printf("preload [N]  rms of v_out [m/s]\n");
        for (const double preload_n : {0.01, 0.1, 1.0}) {
            hertzline::Scene scene;  // the built-in one: six aluminium spheres before a plate in water
            scene.chain.preload_n = preload_n;
            std::printf("%11g  %.6g\n", preload_n, output_rms(scene));
        }
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';  // a scene that cannot be simulated names each key that is wrong
        return 1;
    }
}
