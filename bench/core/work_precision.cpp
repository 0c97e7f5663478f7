// Measures error against run time of hertzline's integrators and of general-purpose solvers, in one process on the
// same scenes. plot_work_precision.py draws the results.
//
//     bench_work_precision [--json FILE] [--scene REFERENCE]... [--repetitions N] [--check]

#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/core/frontier.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/json.hpp"

namespace {

using namespace hertzline;
using bench::Judged;
using bench::Kind;
using bench::Result;
const char* text(Kind kind) {
    return kind == Kind::ours ? "ours" : kind == Kind::located ? "located" : "as it comes";
}

std::string processor() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.starts_with("model name")) {
            return line.substr(line.find(':') + 2);
        }
    }
    return "unknown";
}

Json machine() {
    return {{"processor", processor()},
            {"cores", std::thread::hardware_concurrency()},
            {"compiler", "g++ " __VERSION__},
            {"simd", kernels::kernel_target()},
            {"peer_flags", HERTZLINE_PEER_FLAGS}};
}

Json table(const std::string& scene, const std::vector<Result>& results, double simulated_s) {
    Json rows = Json::array();
    std::printf("\n%s\n%-32s %-18s %9s %9s %9s %12s %9s\n", scene.c_str(), "solver", "setting", "v_last",
                "v_plate", "v_out", "real-time", "fastest");
    for (const Result& r : results) {
        if (!r.failure.empty()) {
            std::printf("%-32s %-18s failed: %s\n", r.solver.c_str(), r.setting.c_str(), r.failure.c_str());
            continue;
        }
        std::printf("%-32s %-18s %9.1e %9.1e %9.1e %12.3g %9.3g\n", r.solver.c_str(), r.setting.c_str(),
                    r.error_v_last, r.error_v_plate, r.error_v_out, simulated_s / r.median_s,
                    simulated_s / r.fastest_s);
        rows.push_back({{"solver", r.solver},
                        {"kind", text(r.kind)},
                        {"setting", r.setting},
                        {"error_v_last", r.error_v_last},
                        {"error_v_plate", r.error_v_plate},
                        {"error_v_out", r.error_v_out},
                        {"median_s", r.median_s},
                        {"fastest_s", r.fastest_s},
                        {"real_time_factor", simulated_s / r.median_s}});
    }
    return rows;
}

/// Prints the fastest solver for each bound of the error: of hertzline, of the peers as they come, of all peers.
Json summary(const std::vector<Result>& results, double simulated_s, Judged judged) {
    Json rows = Json::array();
    std::printf("\n%-9s  %-32s  %-42s  %-42s %7s\n",
                judged == Judged::by_all ? "all <=" : "v_last <=", "hertzline", "best peer as it comes",
                "best peer", "ratio");
    for (const double bound : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
        const Result* ours = bench::fastest(results, {Kind::ours}, bound, judged);
        const Result* plain = bench::fastest(results, {Kind::as_it_comes}, bound, judged);
        const Result* peer = bench::fastest(results, {Kind::as_it_comes, Kind::located}, bound, judged);
        const auto factor = [&](const Result* r) { return r == nullptr ? 0 : simulated_s / r->median_s; };
        const auto name = [](const Result* r) { return r == nullptr ? "-" : r->solver.c_str(); };
        const double ratio = peer == nullptr ? 0 : factor(ours) / factor(peer);
        std::printf("%-9.0e %7.3g  %-24s %7.3g  %-34s %7.3g  %-34s %7.2f\n", bound, factor(ours), name(ours),
                    factor(plain), name(plain), factor(peer), name(peer), ratio);
        rows.push_back({{"error", bound},
                        {"judged", judged == Judged::by_all ? "all" : "v_last"},
                        {"ours", name(ours)},
                        {"ours_real_time_factor", factor(ours)},
                        {"peer_as_it_comes", name(plain)},
                        {"peer_as_it_comes_real_time_factor", factor(plain)},
                        {"peer", name(peer)},
                        {"peer_real_time_factor", factor(peer)},
                        {"ratio", ratio}});
    }
    return rows;
}

/// Checks that the peers solve the model's equations: at their tightest settings they must meet the references.
/// Returns the exit status.
int check(const std::vector<std::string>& scenes) {
    constexpr double bound = 1e-6;
    int faults = 0;
    for (const std::string& scene : scenes) {
        const bench::Field field(scene);
        for (const char* solver : {"odeint dopri5", "odeint dopri5, located", "CVODE Adams, located",
                                   "ARKODE Dormand-Prince", "ARKODE Dormand-Prince, located"}) {
            const std::optional<Result> result = field.tightest(solver);
            if (!result) {
                const bool must_be_there = std::string_view(solver).starts_with("odeint");
                std::printf("%-24s %-32s not built\n", scene.c_str(), solver);
                faults += must_be_there ? 1 : 0;  // others need SUNDIALS
                continue;
            }
            std::printf("%-24s %-32s %9.1e %s\n", scene.c_str(), solver, result->error(),
                        result->failure.c_str());
            faults += result->error() <= bound ? 0 : 1;
        }
    }
    return faults == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> scenes{"paper_vitreous_carbon", "paper_wall", "sonic_vacuum_10",
                                    "small_amplitude_wall"};
    std::string json;
    int repetitions = 5;
    bool only_check = false;
    CLI::App app("Error against run time of hertzline and of general-purpose solvers");
    app.add_option("--json", json, "file for all results");
    app.add_option("--scene", scenes, "scenes, by the names of tests/reference")->capture_default_str();
    app.add_option("--repetitions", repetitions, "rounds of all solvers")->capture_default_str();
    app.add_flag("--check", only_check, "only check that the peers solve the model's equations");
    CLI11_PARSE(app, argc, argv);
    if (only_check) {
        return check(scenes);
    }

    Json all{{"machine", machine()}, {"scenes", Json::array()}};
    std::printf("%s\n", all["machine"].dump().c_str());
    for (const std::string& scene : scenes) {
        const bench::Field field(scene);
        const std::vector<Result> results = field.measure(repetitions);
        Json entry{{"scene", scene}, {"simulated_s", field.simulated_s()}};
        entry["results"] = table(scene, results, field.simulated_s());
        entry["fastest"] = summary(results, field.simulated_s(), Judged::by_v_last);
        entry["fastest_by_all"] = summary(results, field.simulated_s(), Judged::by_all);
        all["scenes"].push_back(entry);
    }
    if (!json.empty()) {
        std::ofstream(json) << all.dump(2) << '\n';
    }
    return 0;
}
