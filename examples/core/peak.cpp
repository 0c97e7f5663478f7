// Runs a scene and prints the peak of the velocity that goes into the medium.
//
//     peak [SCENE.toml]        without a file: the built-in scene

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>

#include <hertzline/hertzline.hpp>

namespace {

hertzline::Scene read_scene(const std::string& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file) {
        throw std::runtime_error("cannot read " + path);
    }
    const auto parsed = hertzline::parse_scene(text.str(), path);
    if (!parsed) {
        std::string faults;
        for (const hertzline::Fault& fault : parsed.error()) {
            faults += fault.message() + '\n';
        }
        throw std::runtime_error(faults);
    }
    return parsed->scene;
}

void run(const hertzline::Scene& scene) {
    // resolve() chooses the integrator and the step where the scene leaves them open. Taps that are not asked for are not computed.
    hertzline::Simulation simulation(hertzline::resolve(scene), {.taps = hertzline::Tap::v_out});
    hertzline::Samples block = simulation.make_samples(1024);

    const double rate = scene.output.sample_rate_hz;
    auto left = static_cast<std::size_t>(std::llround(scene.output.duration_s * rate));
    double peak = 0;
    double peak_time = 0;
    while (left > 0) {
        const std::size_t count = std::min(left, block.capacity());
        if (simulation.advance(block, count) != hertzline::Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        const std::span<const double> v_out = block[hertzline::Tap::v_out];
        for (std::size_t i = 0; i < v_out.size(); ++i) {
            if (std::abs(v_out[i]) > peak) {
                peak = std::abs(v_out[i]);
                peak_time = static_cast<double>(block.first + static_cast<std::int64_t>(i)) / rate;
            }
        }
        left -= block.count;
    }
    std::printf("peak of v_out: %.6g m/s at %.6g us\n", peak, 1e6 * peak_time);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run(argc > 1 ? read_scene(argv[1]) : hertzline::Scene());
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
