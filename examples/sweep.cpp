// Runs a scene for thirty preloads on all processors and prints the one with the highest peak at the output. Nothing is written.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <vector>

#include <hertzline/hertzline.hpp>

int main() {
    try {
        const hertzline::Scene scene = hertzline::read_scene("paper-vitreous-carbon");
        const hertzline::StudyTable table = hertzline::sweep(scene, {{"chain.preload_n", "0.01..10:log:30"}});
        const std::vector<double> peaks = table["peak_v_out_m_per_s"];
        const auto best = std::max_element(peaks.begin(), peaks.end()) - peaks.begin();
        std::printf("preload %g N: %g m/s\n", table["chain.preload_n"][static_cast<std::size_t>(best)],
                    peaks[static_cast<std::size_t>(best)]);
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';  // a wrong key or value is named with the allowed ones
        return 1;
    }
}
