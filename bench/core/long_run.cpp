// Measures how the energy of an undamped chain drifts in a long run.
//
//     bench_long_run [--json FILE] [STEPS]        1e8 by default; 1e9 take some minutes
//
// Nine spheres between horn and wall start at random velocities: at low ones all contacts stay closed, at high ones
// they open and close all the time. Prints the largest energy error after 1e4, 1e5, ... steps, and the exponent of its
// growth: 0 where the method keeps the energy, 1/2 where errors add up at random, 1 where the energy drifts.

#include <cmath>
#include <cstdio>
#include <string>

#include "bench/support/arguments.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "tests/support/bare_chain.hpp"

namespace {

using namespace hertzline;

constexpr double step_s = 20e-9;
constexpr double gently = 3e-3;  // [m/s], scale of the initial velocities
constexpr double hard = 0.3;

Json measure(Integrator integrator, double speed, double max_steps) {
    const double at_rest = test::thrown(integrator, step_s, 0).energy();
    test::BareChain chain = test::thrown(integrator, step_s, speed);
    const double put_in = chain.energy() - at_rest;
    const std::string name(word(integrator));
    Json rows = Json::array();
    double largest = 0;
    double before = 0;
    for (double steps = 1e4; steps <= max_steps; steps *= 10) {
        const auto left = static_cast<std::int64_t>(steps) - chain.state.step;
        largest =
            std::max(test::largest_energy_change(chain, at_rest, put_in, left), largest);  // a NaN stays
        const double now = (chain.energy() - at_rest) / put_in - 1;
        const double growth = before > 0 ? std::log10(largest / before) : NAN;
        before = largest;
        std::printf("%-9s %6g %8.0e %14.3g %+14.3g %8.2f %14lld\n", name.c_str(), speed, steps, largest, now,
                    growth, static_cast<long long>(chain.contact_events()));
        std::fflush(stdout);
        rows.push_back({{"integrator", name},
                        {"speed_m_per_s", speed},
                        {"steps", steps},
                        {"largest_energy_error", largest},
                        {"energy_error", now},
                        {"growth_exponent", growth},
                        {"contact_events", chain.contact_events()}});
    }
    return rows;
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    const double steps = arguments.words.empty() ? 1e8 : std::stod(arguments.words[0]);
    std::printf("%s, steps of %g ns\n%-9s %6s %8s %14s %14s %8s %14s\n", kernels::kernel_target(),
                step_s * 1e9, "method", "m/s", "steps", "largest error", "error now", "growth",
                "contact events");
    Json rows = Json::array();
    for (const Integrator integrator : choices<Integrator>) {
        for (const double speed : {gently, hard}) {
            for (const auto& row : measure(integrator, speed, steps)) {
                rows.push_back(row);
            }
        }
    }
    arguments.save(rows);
    return 0;
}
