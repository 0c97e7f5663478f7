// Measures whether whole runs keep the requested accuracy, and whether the program warns of those that do not.
//
//     bench_accuracy [--json FILE] [--threads N] [COUNT [SEED]]
//     bench_accuracy --finer-run [COUNT [SEED]]            for the points of a sweep
//     bench_accuracy --integrator chin4a [COUNT [SEED]]    by this method
//     bench_accuracy --wet [COUNT [SEED]]                  modal plates in their fluid, with points, and no references
//     bench_accuracy --mixed [COUNT [SEED]]                chains of different spheres, struck ones, weights and holders, no references
//     bench_accuracy --arrays [COUNT [SEED]]               arrays of 2 to 19 chains, no references
//     bench_accuracy --scene SEED INDEX
//
// The scenes of tests/reference/accuracy/ come first; they have independent solutions. COUNT plausible devices, drawn
// at random, follow. Their reference is taylor12 with the shortest useful pieces, and its error is measured by another
// run with longer ones. An error is the relative L2 norm of the worst of v_last, v_plate and v_out, or of v_last, v_centre, v_face, p_axis
// and each of p_points, over the whole run.
// --scene prints a scene.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/core/accuracy_tables.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/design_scene.hpp"
#include "tests/support/judged_scene.hpp"
#include "tests/support/reference.hpp"

namespace {

using namespace hertzline;
using bench::JudgedScene;
constexpr std::array accuracies{1e-3, 1e-4, 1e-6};

/// Runs job(0) to job(count - 1) in threads. Returns their results in this order.
template <class Job>
std::vector<JudgedScene> in_parallel(std::size_t count, unsigned threads, Job job) {
    std::vector<JudgedScene> results(count);
    std::atomic<std::size_t> next = 0;
    std::vector<std::future<void>> workers;
    for (unsigned i = 0; i < threads; ++i) {
        workers.push_back(std::async(std::launch::async, [&] {
            for (std::size_t number = next++; number < count; number = next++) {
                results[number] = job(number);
            }
        }));
    }
    for (std::future<void>& worker : workers) {
        worker.get();
    }
    return results;
}

using Judge = std::function<test::Judgement(const Scene&, const test::Truth&, double)>;

JudgedScene judged(const Judge& judge, std::string name, test::DesignScene design, const test::Truth& truth) {
    JudgedScene result{std::move(name), std::move(design), {}};
    for (const double accuracy : accuracies) {
        result.judgements.push_back(judge(result.design.scene, truth, accuracy));
    }
    return result;
}

JudgedScene judged_reference(const Judge& judge, const std::string& name) {
    const Scene scene = test::random_reference_scene(name);
    return judged(judge, name, {scene}, test::independent_truth_of(scene, name));
}

using Designs = test::DesignScene (*)(std::uint64_t seed, std::uint64_t index);

JudgedScene judged_design(const Judge& judge, Designs designs, std::uint64_t seed, std::uint64_t index) {
    const test::DesignScene design = designs(seed, index);
    return judged(judge, std::to_string(index), design, test::truth_of(design.scene));
}

Json json(const std::vector<JudgedScene>& scenes) {
    Json rows = Json::array();
    for (const JudgedScene& scene : scenes) {
        for (const test::Judgement& judgement : scene.judgements) {
            rows.push_back({{"scene", scene.name},
                            {"description", test::description(scene.design.scene)},
                            {"near_paper", scene.design.near_paper},
                            {"integrator", word(judgement.integrator)},
                            {"accuracy", judgement.accuracy},
                            {"error", judgement.error},
                            {"truth_error", judgement.truth_error},
                            {"estimated_error", judgement.estimate ? Json(*judgement.estimate) : Json()},
                            {"warned", judgement.warned},
                            {"amplifies", judgement.amplifies()}});
        }
    }
    return rows;
}

/// Prints the tables of the drawn scenes.
void print(const std::vector<JudgedScene>& scenes) {
    if (scenes.empty()) {
        return;
    }
    bench::print_groups(scenes);
    bench::print_pilots(scenes);
    bench::print_silent_misses(scenes);
    bench::print_estimates(scenes);
    bench::print_misses(scenes);
}

}  // namespace

int main(int argc, char** argv) {
    std::size_t count = 100;
    std::uint64_t seed = 1;
    unsigned threads = std::max(1U, std::thread::hardware_concurrency());
    std::vector<std::uint64_t> wanted;
    std::string json_file;
    bool finer_run = false;
    bool wet = false;
    bool mixed = false;
    bool arrays = false;
    std::optional<Integrator> integrator;
    CLI::App app("Accuracy asked for, estimated and true, of whole runs");
    app.add_option("COUNT", count, "scenes to draw")->capture_default_str();
    app.add_option("SEED", seed, "seed of the scenes")->capture_default_str();
    app.add_option("--threads", threads, "number of threads")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    app.add_option("--scene", wanted, "SEED and INDEX of a scene to print")->expected(2);
    std::map<std::string, Integrator> integrators;
    for (const Integrator choice : choices<Integrator>) {
        integrators.emplace(word(choice), choice);
    }
    app.add_option("--integrator", integrator, "use this integrator for all scenes")
        ->transform(CLI::CheckedTransformer(integrators));
    app.add_flag("--finer-run", finer_run,
                 "choose steps and estimate errors by a finer run, as a sweep does");
    CLI::Option* const of_plates = app.add_flag("--wet", wet, "draw modal plates in their fluid");
    app.add_flag("--mixed", mixed, "draw chains of different spheres")->excludes(of_plates);
    app.add_flag("--arrays", arrays, "draw arrays of chains");
    app.add_option("--json", json_file, "file for all results");
    CLI11_PARSE(app, argc, argv);
    const Designs designs = wet      ? test::wet_design_scene
                            : mixed  ? test::mixed_design_scene
                            : arrays ? test::array_design_scene
                                     : test::design_scene;
    if (!wanted.empty()) {
        const Scene scene = designs(wanted[0], wanted[1]).scene;
        std::printf("# %s\n%s", test::description(scene).c_str(), to_toml(scene).c_str());
        return 0;
    }

    const Judge judge = [=](Scene scene, const test::Truth& truth, double accuracy) {
        scene.numerics.integrator = integrator;
        return finer_run ? test::judged_by_finer_run(scene, truth, accuracy)
                         : test::judged(scene, truth, accuracy);
    };
    std::printf("outputs below %.0e of the loudest velocity are judged on that scale\n\n",
                test::quietest_output);
    const std::vector<std::string> names =
        wet || mixed || arrays ? std::vector<std::string>() : test::random_references();
    const std::vector<JudgedScene> references = in_parallel(
        names.size(), threads, [&](std::size_t number) { return judged_reference(judge, names[number]); });
    bench::print_scenes(references);
    std::fflush(stdout);
    const std::vector<JudgedScene> drawn = in_parallel(
        count, threads, [&](std::size_t index) { return judged_design(judge, designs, seed, index); });
    print(drawn);
    if (!json_file.empty()) {
        std::ofstream(json_file) << Json{{"references", json(references)}, {"drawn", json(drawn)}}.dump(2)
                                 << '\n';
    }
    return 0;
}
