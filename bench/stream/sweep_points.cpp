// Measures the time of a sweep's points beside the same points with a process of `hertzline run` for each, and with Boost.odeint's
// dopri5 at the same error. Threads take one point after another.
//
//     bench_sweep_points [--json FILE] [POINTS [THREADS]]
//
// The points are the paper's device of vitreous carbon at other preloads. An error is the relative L2 norm of the difference of v_last
// from taylor12 with short pieces, over 500 us. A peer has the loosest tolerance whose median error is at most the sweep's.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/peers/problem.hpp"
#include "bench/support/arguments.hpp"
#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "studies/study.hpp"
#include "studies/workers.hpp"

namespace {

using namespace hertzline;
using bench::Contender;
using bench::Problem;
using bench::Trace;
constexpr int rounds = 5;
constexpr std::int64_t judged_points = 50;
constexpr double finer_steps = 0.75;  // as in core/step_choice/finer_run.cpp

/// Runs a point.
using RunPoint = std::function<void(std::int64_t point)>;

/// Of this process and of those that it has started and that have ended.
double processor_s() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    rusage children{};
    getrusage(RUSAGE_CHILDREN, &children);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec) +
           seconds(children.ru_utime) + seconds(children.ru_stime);
}

/// Runs the program to its end; its output goes nowhere.
void run_program(std::vector<std::string> words) {
    words.insert(words.begin(), HERTZLINE_PROGRAM);
    std::vector<char*> argv;
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
        posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_WRONLY, 0);
    }
    pid_t child = 0;
    int status = posix_spawn(&child, argv[0], &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (status != 0 || waitpid(child, &status, 0) != child || status != 0) {
        std::fprintf(stderr, "%s %s failed\n", argv[0], argv[1]);
        std::exit(1);
    }
}

struct Cost {
    double wall_s = 0;
    double processor_s = 0;
};

Cost cost_of(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    const double before = processor_s();
    work();
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
            processor_s() - before};
}

void in_threads(std::int64_t points, int threads, const RunPoint& run) {
    std::atomic<std::int64_t> next{0};
    std::vector<std::jthread> pool;
    for (int i = 0; i < threads; ++i) {
        pool.emplace_back([&] {
            for (std::int64_t point = next++; point < points; point = next++) {
                run(point);
            }
        });
    }
}

/// The sweep and its points.
class Subject {
public:
    static constexpr const char* scene_name = "paper-vitreous-carbon";
    static std::string axis_of(std::int64_t points) {
        return "chain.preload_n=0.01..2:log:" + std::to_string(points);
    }

    explicit Subject(std::int64_t points) : sweep_{plan_of(points), {}, {}} {
        sweep_.options.columns = measures::number_columns({}, false);
    }

    const studies::Study& sweep() const { return sweep_; }
    std::int64_t points() const { return sweep_.plan.size(); }
    static std::size_t samples(const Scene& scene) {
        return static_cast<std::size_t>(std::lround(scene.output.duration_s * scene.output.sample_rate_hz)) +
               1;
    }
    std::int64_t judged(std::int64_t i) const { return i * points() / std::min(judged_points, points()); }

    void run(int threads) const {
        studies::Journal journal = studies::Journal::in_memory();
        journal.begin(studies::journal_text(sweep_), studies::columns_of(sweep_));
        studies::load_rows(journal, sweep_);
        std::vector<std::int64_t> all(static_cast<std::size_t>(points()));
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i] = static_cast<std::int64_t>(i);
        }
        static const std::atomic<bool> never{false};
        studies::run_points(sweep_, journal, all, threads, never, [](const studies::PointCounts&) {});
    }

    /// The whole sweep as its user runs it.
    void run_process(int threads) const {
        const std::filesystem::path table = std::filesystem::temp_directory_path() /
                                            ("bench_sweep_points." + std::to_string(getpid()) + ".csv");
        run_program({"sweep", scene_name, "--vary", axis_of(points()), "--jobs", std::to_string(threads),
                     "-o", table.string()});
        std::filesystem::remove(table);
    }

    /// A process for one point, with the numbers of its row.
    void run_alone(std::int64_t point) const {
        char setting[48];
        std::snprintf(setting, sizeof setting, "chain.preload_n=%.17g",
                      sweep_.plan.scene(point).chain.preload_n);
        run_program({"run", scene_name, "--set", setting, "--json"});
    }

    /// Returns the point's scene with the integrator and the step that the sweep chooses.
    Scene settled(std::int64_t point) const {
        static const std::atomic<bool> never{false};
        studies::PointOptions options;
        options.columns = {*measures::find_column("step_s")};
        Scene scene = sweep_.plan.scene(point);
        const auto row = studies::PointRunner(options, never).run(point, scene);
        scene.numerics = {
            .integrator = Integrator::taylor8, .step_s = row->numbers[0], .accuracy = {}, .poles = {}};
        return resolve(scene).scene;
    }

private:
    static studies::SweepPlan plan_of(std::int64_t points) {
        const Scene base = parse_scene(find_shipped_scene(scene_name)->text, "the scene")->scene;
        return *studies::SweepPlan::make(base, {{axis_of(points)}, "", "", std::nullopt});
    }

    studies::Study sweep_;
};

double error_of(const Trace& trace, const Trace& truth) {
    double difference = 0;
    double norm = 0;
    for (std::size_t i = 0; i < truth.v_last.size(); ++i) {
        difference += std::pow(trace.v_last[i] - truth.v_last[i], 2);
        norm += std::pow(truth.v_last[i], 2);
    }
    return std::sqrt(difference / norm);
}

double quantile(std::vector<double> values, double share) {
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Points with reference solutions, by which contenders are judged.
class Bench {
public:
    explicit Bench(const Subject& subject) : subject_(subject) {
        for (std::int64_t i = 0; i < std::min(judged_points, subject.points()); ++i) {
            Scene scene = subject.sweep().plan.scene(subject.judged(i));
            scene.numerics = {
                .integrator = Integrator::taylor12, .step_s = 100e-9, .accuracy = {}, .poles = {}};
            truths_.push_back(trace_of(bench::hertzline_contender(resolve(scene).scene), scene));
        }
    }

    /// Returns the error at each point of the contender that `make` makes.
    std::vector<double> errors(const std::function<Contender(const Scene&, const Problem&)>& make,
                               bool settled) const {
        std::vector<double> errors;
        for (std::size_t i = 0; i < truths_.size(); ++i) {
            const std::int64_t point = subject_.judged(static_cast<std::int64_t>(i));
            const Scene scene = settled ? subject_.settled(point) : subject_.sweep().plan.scene(point);
            const Problem problem = bench::problem(scene, Subject::samples(scene));
            errors.push_back(error_of(trace_of(make(scene, problem), scene), truths_[i]));
        }
        return errors;
    }

private:
    static Trace trace_of(const Contender& contender, const Scene& scene) {
        Trace trace(bench::problem(scene, Subject::samples(scene)));
        contender.run(trace);
        return trace;
    }

    const Subject& subject_;
    std::vector<Trace> truths_;
};

struct Row {
    std::string name;
    std::string setting;
    std::vector<double> errors;
    std::function<void(int threads)> run;
    std::vector<Cost> costs;
    std::optional<std::int64_t> points = {};  ///< that it takes of them, evenly spread; all unless given
};

using MakePeer = Contender (*)(const Problem&, double tolerance);

/// Makes a peer at the loosest tolerance with at most that median error.
Row peer(const Subject& subject, const Bench& bench, const char* name, MakePeer make, double median) {
    for (double tolerance = 1e-2; tolerance > 1e-12; tolerance /= std::sqrt(10.0)) {
        const std::vector<double> errors = bench.errors(
            [&](const Scene&, const Problem& problem) { return make(problem, tolerance); }, false);
        if (quantile(errors, 0.5) > median) {
            continue;
        }
        const auto run_point = [&subject, make, tolerance](std::int64_t point) {
            const Scene scene = subject.sweep().plan.scene(point);
            const Problem problem = bench::problem(scene, Subject::samples(scene));
            Trace trace(problem);
            make(problem, tolerance).run(trace);
        };
        char setting[32];
        std::snprintf(setting, sizeof setting, "tolerance %.1e", tolerance);
        return {name,
                setting,
                errors,
                [&subject, run_point](int threads) { in_threads(subject.points(), threads, run_point); },
                {}};
    }
    std::fprintf(stderr, "%s never meets the error\n", name);
    std::exit(1);
}

/// Of a point. @param points that rows take unless they say otherwise
double median_of(const Row& row, double Cost::*member, std::int64_t points) {
    std::vector<double> values;
    std::ranges::transform(row.costs, std::back_inserter(values), std::mem_fn(member));
    return quantile(values, 0.5) / static_cast<double>(row.points.value_or(points));
}

void print(const Row& row, std::int64_t points, Json& results) {
    const double per_s = 1 / median_of(row, &Cost::wall_s, points);
    const double processor_us = 1e6 * median_of(row, &Cost::processor_s, points);
    std::printf("%-42s %-18s %9.1e %9.1e %12.0f %14.0f\n", row.name.c_str(), row.setting.c_str(),
                quantile(row.errors, 0.5), quantile(row.errors, 0.95), per_s, processor_us);
    results.push_back({{"name", row.name},
                       {"setting", row.setting},
                       {"median_error", quantile(row.errors, 0.5)},
                       {"error_of_95_percent", quantile(row.errors, 0.95)},
                       {"points_per_s", per_s},
                       {"processor_us_per_point", processor_us}});
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Arguments arguments(argc, argv);
    const std::int64_t points = arguments.words.empty() ? 500 : std::stoll(arguments.words[0]);
    const int threads = arguments.words.size() < 2 ? 1 : std::stoi(arguments.words[1]);
    const Subject subject(points);
    const Bench bench(subject);
    const auto ours = [](const Scene& scene, const Problem&) { return bench::hertzline_contender(scene); };
    const std::vector<double> errors = bench.errors(ours, true);
    const double median = quantile(errors, 0.5);
    std::vector<Scene> settled;
    for (std::int64_t point = 0; point < points; ++point) {
        settled.push_back(subject.settled(point));
    }
    const auto simulate = [&](std::int64_t point) {
        const Scene& scene = settled[static_cast<std::size_t>(point)];
        Trace trace(bench::problem(scene, Subject::samples(scene)));
        bench::hertzline_contender(scene).run(trace);
    };
    // the only part that batches of scenes could speed up: the motion of the run and of the finer run beside it
    const auto move_on = [&](std::int64_t point) {
        Scene scene = settled[static_cast<std::size_t>(point)];
        const auto samples = static_cast<std::int64_t>(Subject::samples(scene));
        static_cast<void>(Simulation(scene).skip(samples));
        *scene.numerics.step_s *= finer_steps;
        static_cast<void>(Simulation(scene, {.ledger = LedgerKeeping::off}).skip(samples));
    };
    const auto resolved = [](const Scene& scene, const Problem&) {
        return bench::hertzline_contender(resolve(scene).scene);
    };
    const std::int64_t processes = std::min(judged_points, points);
    enum : std::size_t { of_points, of_samples, of_pieces, of_sweep, of_runs };
    std::vector<Row> rows;
    rows.push_back({"hertzline sweep, with all measures",
                    "default accuracy",
                    errors,
                    [&](int count) { subject.run(count); },
                    {}});
    rows.push_back({"hertzline taylor8, samples alone",
                    "the sweep's step",
                    errors,
                    [&](int count) { in_threads(points, count, simulate); },
                    {}});
    rows.push_back({"hertzline taylor8, pieces of two runs",
                    "the sweep's steps",
                    errors,
                    [&](int count) { in_threads(points, count, move_on); },
                    {}});
    rows.push_back({"hertzline sweep, a process with its table",
                    "default accuracy",
                    errors,
                    [&](int count) { subject.run_process(count); },
                    {}});
    rows.push_back({"hertzline run, a process for each point",
                    "default accuracy",
                    bench.errors(resolved, false),
                    [&](int count) {
                        in_threads(processes, count,
                                   [&](std::int64_t i) { subject.run_alone(subject.judged(i)); });
                    },
                    {},
                    processes});
    rows.push_back(
        peer(subject, bench, "odeint dopri5, contacts located", bench::odeint_dopri5_located, median));
    rows.push_back(peer(subject, bench, "odeint dopri5, as it comes", bench::odeint_dopri5, median));
    for (int round = 0; round < rounds; ++round) {
        for (Row& row : rows) {
            row.costs.push_back(cost_of([&] { row.run(threads); }));
        }
    }
    std::printf("%lld points in %d thread%s\n%-42s %-18s %9s %9s %12s %14s\n", static_cast<long long>(points),
                threads, threads == 1 ? "" : "s", "", "setting", "median", "95 %", "points/s",
                "processor us");
    Json results = Json::array();
    for (const Row& row : rows) {
        print(row, points, results);
    }
    const auto over = [&](std::size_t a, std::size_t b, double Cost::*member) {
        return median_of(rows[a], member, points) / median_of(rows[b], member, points);
    };
    const double over_pieces = over(of_points, of_pieces, &Cost::processor_s);
    const double runs_over_sweep = over(of_runs, of_sweep, &Cost::wall_s);
    std::printf("a point over the pieces of its two runs: %.2f\na loop of runs over the sweep: %.1f\n",
                over_pieces, runs_over_sweep);
    arguments.save({{"points", points},
                    {"threads", threads},
                    {"rows", results},
                    {"point_over_pieces", over_pieces},
                    {"runs_over_sweep", runs_over_sweep}});
    return 0;
}
