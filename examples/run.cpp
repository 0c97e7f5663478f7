// Runs a shipped scene with another preload and prints a number of its summary.
#include <cstdio>

#include <hertzline/hertzline.hpp>

int main() {
    hertzline::Scene scene = hertzline::read_scene("paper-vitreous-carbon");  // or a file
    scene.chain.preload_n = 0.2;
    std::printf("%g m/s\n", hertzline::run(scene)["peak_v_out_m_per_s"]);
}
