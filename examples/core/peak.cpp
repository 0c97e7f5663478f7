// Steps a scene block by block and prints the peak of the velocity that goes into the medium. Needs the physics alone.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <hertzline/resolve.hpp>
#include <hertzline/simulation.hpp>

int main() {
    const hertzline::Scene scene;  // the paper's device
    // resolve() chooses the integrator and the step where the scene leaves them open. Taps that are not asked for are not computed.
    hertzline::Simulation simulation(hertzline::resolve(scene), {.taps = hertzline::Tap::v_out});
    hertzline::Samples block = simulation.make_samples(1024);

    auto left = static_cast<std::size_t>(scene.output.duration_s * scene.output.sample_rate_hz);
    double peak = 0;
    while (left > 0) {
        if (simulation.advance(block, std::min(left, block.capacity())) != hertzline::Status::running) {
            std::fprintf(stderr, "%s\n", simulation.failure().c_str());
            return EXIT_FAILURE;
        }
        for (const double v_out : block[hertzline::Tap::v_out]) {
            peak = std::max(peak, std::abs(v_out));
        }
        left -= block.count;
    }
    std::printf("peak of v_out: %.6g m/s\n", peak);
}
