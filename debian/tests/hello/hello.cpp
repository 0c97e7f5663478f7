// Runs a shipped scene with a changed preload: the program of README.md.
#include <cstdio>

#include <hertzline/hertzline.hpp>

int main() {
    hertzline::Scene scene = hertzline::read_scene("paper-stream");
    scene.chain.preload_n = 0.2;
    const double peak = hertzline::run(scene)["peak_v_out_m_per_s"];
    std::printf("%g m/s\n", peak);
    return peak > 0 ? 0 : 1;
}
