// Measures the longest stable step, beside the limit that `hertzline check` prints. plot_stability.py draws the results.
//
//     bench_stability [--json FILE]
//
// The scenes are the paper's device, changed along one axis at a time, and a few combinations. A step is stable when
// the energy held in the chain stays below a hundred times the largest of a finely resolved run: close to the limit
// it swings, beyond it grows without bound. The grid's kernels run here without the check that ends a run beyond the
// limit. Steps are lengthened by 2 % until one is unstable.
//
// Series shorten their pieces themselves: the step is the longest piece and sets the tolerance. Their steps are tried
// up to 100 times the advised limit; the residual of the ledger is measured at ten times that limit.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "bench/support/arguments.hpp"
#include "core/integrators/kernels.hpp"
#include "core/integrators/simd_chain.hpp"
#include "core/model/end.hpp"
#include "core/model/energy.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "core/step_choice/step_advice.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"

namespace {

using namespace hertzline;
constexpr double factor = 1.02;             // from one step tried to the next
constexpr double series_searched = 100;     // times the advised limit
constexpr double blown_up = 100;            // times the largest energy of a finely resolved run
constexpr double beyond = 10;               // times the advised limit, where the ledger of series is checked
constexpr std::int64_t min_steps = 10'000;  // enough for an instability to grow

struct Axis {
    std::string name;
    std::string unit;
    std::vector<double> values;
    std::function<void(Scene&, double)> change;
};

double sphere_mass(const Chain& chain) {
    return 1 / chain.inv_mass[0];
}

/// Returns the damping [kg/s] at which two spheres of the paper's chain at rest no longer swing against each other.
double critical_damping() {
    const Chain chain{Scene{}};
    const double tangent = 1.5 * chain.stiffness[1] * std::sqrt(chain.static_overlap[1]);
    return 2 * std::sqrt(tangent * sphere_mass(chain) / 2);
}

/// Sets a plate as stiff as the paper's, whose moving mass is `ratio` times a sphere's.
void set_mass_ratio(Scene& scene, double ratio) {
    const Chain chain(scene);
    scene.end.stiffness_n_per_m = chain.spring[chain.spheres()];
    scene.end.thickness_m *= ratio * sphere_mass(chain) * chain.inv_mass[chain.spheres()];
}

std::vector<Axis> axes() {
    const double critical = critical_damping();
    const double amplitude = Scene{}.drive.amplitude_m;
    return {
        {"preload", "N", {0, 1e-3, 1e-2, 0.1, 1, 10, 100}, [](Scene& s, double f) { s.chain.preload_n = f; }},
        {"damping",
         "of critical",
         {0, 0.003, 0.01, 0.03, 0.1, 0.3, 1},
         [critical](Scene& s, double share) { s.chain.damping_kg_per_s = share * critical; }},
        {"amplitude",
         "of the paper's",
         {1e-3, 1e-2, 0.1, 1, 10, 100},
         [amplitude](Scene& s, double times) { s.drive.amplitude_m = times * amplitude; }},
        {"plate stiffness",
         "N/m",
         {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10},
         [](Scene& s, double k) { s.end.stiffness_n_per_m = k; }},
        {"plate mass", "of a sphere", {1e-2, 0.1, 1, 10, 100, 1000}, set_mass_ratio},
        {"combination",
         "number",
         {1, 2, 3, 4},
         [critical](Scene& s, double number) {
             if (number == 1) {  // pressed hard and driven hard
                 s.chain.preload_n = 100;
                 s.drive.amplitude_m *= 10;
             } else if (number == 2) {  // a light plate on a hard spring
                 set_mass_ratio(s, 0.1);
                 s.end.stiffness_n_per_m = 1e8;
             } else if (number == 3) {  // no preload, strong damping
                 s.chain.preload_n = 0;
                 s.chain.damping_kg_per_s = critical;
             } else {  // driven hard, no damping
                 s.drive.amplitude_m *= 30;
                 s.chain.damping_kg_per_s = 0;
             }
         }},
    };
}

double held(const Chain& chain, const ChainState& state, double horn) {
    return kinetic_energy(chain, state) + stored_energy(chain, state, horn);
}

double simulated_s(const Scene& scene, double step) {
    return std::max(1.5 * scene.drive.cycles / scene.drive.frequency_hz,
                    static_cast<double>(min_steps) * step);
}

/// Returns the largest energy held [J] in a run on a grid; infinity when the motion diverges.
double largest_held_on_grid(const Scene& scene, Integrator integrator, double step, double bound) {
    const Chain chain(scene);
    ChainState state(chain);
    ToneBurst burst(scene.drive, step);
    kernels::SimdChain folded(chain, integrator, kernels::kernel_lanes());
    folded.step_s = step;
    folded.load(chain, state, chain.bodies());
    std::array<HornStep, ToneBurst::batch_steps> horn{};
    kernels::Trace nothing;
    nothing.capacity = kernels::max_rows_per_step;
    nothing.bodies = chain.bodies();
    const auto steps = static_cast<std::int64_t>(simulated_s(scene, step) / step);
    double largest = 0;
    for (; state.step < steps && largest < bound; state.step += ToneBurst::batch_steps) {
        burst.fill(state.step, horn.data(), ToneBurst::batch_steps);
        kernels::kernel(integrator, folded.rows())(folded, burst, horn.data(), state.step,
                                                   ToneBurst::batch_steps, nothing);
        folded.store(state);
        const double now = held(chain, state, horn.back().end.x);
        largest = now <= largest ? largest : now;
        if (!std::isfinite(now)) {
            return std::numeric_limits<double>::infinity();
        }
    }
    return largest;
}

struct SeriesRun {
    double largest_held = std::numeric_limits<double>::infinity();  ///< [J]
    double residual = std::numeric_limits<double>::infinity();      ///< of the ledger
    double mean_piece_s = 0;
};

SeriesRun run_series(Scene scene, Integrator integrator, double step) {
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = step;
    const double looks = 500;
    const double end = simulated_s(scene, 0);
    scene.output.sample_rate_hz = looks / end;
    Simulation simulation(scene);
    SeriesRun run{0, 0, 0};
    for (int i = 0; i < static_cast<int>(looks); ++i) {
        if (simulation.skip(1) != Status::running) {
            return {};
        }
        // the horn's position matters little here
        run.largest_held = std::max(run.largest_held, held(simulation.chain(), simulation.state(), 0));
    }
    run.residual = simulation.energy_residual();
    run.mean_piece_s = simulation.time_s() / static_cast<double>(simulation.steps());
    return run;
}

/// Returns the largest energy [J] held in a finely resolved run.
double energy_of(const Scene& scene) {
    Scene fine = scene;
    fine.numerics.accuracy = 1e-6;
    fine.numerics.integrator = Integrator::taylor12;
    return run_series(scene, Integrator::taylor12, advise_step(fine).recommended_step_s).largest_held;
}

Json measure(const Axis& axis, double value, Integrator integrator) {
    Scene scene;
    axis.change(scene, value);
    const double bound = blown_up * energy_of(scene);
    scene.numerics.integrator = integrator;
    const StepAdvice advice = advise_step(scene);
    const double advised = advice.largest_stable_step_s;
    Json row{{"axis", axis.name},
             {"unit", axis.unit},
             {"value", value},
             {"integrator", std::string(word(integrator))},
             {"advised_limit_s", advised},
             {"recommended_s", advice.recommended_step_s}};
    const auto stable = [&](double step) {
        return (is_series(integrator) ? run_series(scene, integrator, step).largest_held
                                      : largest_held_on_grid(scene, integrator, step, bound)) < bound;
    };
    const double apart = is_series(integrator) ? 1.5 : factor;
    const double searched = series_searched * advised;
    double step = 0.3 * std::min(advised, 1.0);
    while (step < searched && stable(step * apart)) {
        step *= apart;
    }
    row["measured_s"] = step < searched ? Json(step) : Json(nullptr);
    if (is_series(integrator)) {
        const SeriesRun far = run_series(scene, integrator, beyond * advised);
        row["residual_beyond"] = far.residual;
        row["mean_piece_beyond_s"] = far.mean_piece_s;
    }
    return row;
}

void print(const Json& row) {
    const double advised = row["advised_limit_s"];
    std::printf("%-16s %9.3g %-15s %-9s %10.4g %10.4g ", row["axis"].get<std::string>().c_str(),
                row["value"].get<double>(), row["unit"].get<std::string>().c_str(),
                row["integrator"].get<std::string>().c_str(), row["recommended_s"].get<double>() * 1e9,
                advised * 1e9);
    if (row["measured_s"].is_null()) {
        std::printf("%10s %8s", "none", "> 100");
    } else {
        const double measured = row["measured_s"];
        std::printf("%10.4g %8.2f", measured * 1e9, measured / advised);
    }
    if (row.contains("residual_beyond")) {
        std::printf(" %12.1e %10.4g", row["residual_beyond"].get<double>(),
                    row["mean_piece_beyond_s"].get<double>() * 1e9);
    }
    std::printf("\n");
    std::fflush(stdout);
}

/// Prints for one integrator how often, and how far, the advised limit lies below the measured one.
void summarize(const Json& rows, Integrator integrator) {
    int count = 0;
    int below = 0;
    int within_two = 0;
    int none = 0;
    double worst_residual = 0;
    for (const Json& row : rows) {
        if (row["integrator"] != std::string(word(integrator))) {
            continue;
        }
        ++count;
        worst_residual = std::max(worst_residual, row.value("residual_beyond", 0.0));
        if (row["measured_s"].is_null()) {
            ++none;
            continue;
        }
        const double ratio = row["measured_s"].get<double>() / row["advised_limit_s"].get<double>();
        below += ratio >= 1 ? 1 : 0;
        within_two += ratio >= 1 && ratio <= 2 ? 1 : 0;
    }
    std::printf(
        "%s: of %d points the advised limit lies below the measured one in %d, within 2 x of it in %d, and "
        "no limit was found in %d",
        std::string(word(integrator)).c_str(), count, below + none, within_two, none);
    if (is_series(integrator)) {
        std::printf("; largest residual at %g x the advised limit: %.1e", beyond, worst_residual);
    }
    std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    std::printf("%s, steps in ns\n%-16s %25s %-9s %10s %10s %10s %8s %12s %10s\n", kernels::kernel_target(),
                "axis", "", "method", "recommend", "limit", "measured", "ratio", "residual", "mean piece");
    Json rows = Json::array();
    for (const Axis& axis : axes()) {
        for (const Integrator integrator : choices<Integrator>) {
            for (const double value : axis.values) {
                rows.push_back(measure(axis, value, integrator));
                print(rows.back());
            }
        }
    }
    for (const Integrator integrator : choices<Integrator>) {
        summarize(rows, integrator);
    }
    arguments.save(rows);
    return 0;
}
