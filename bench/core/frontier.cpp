// Measures the solvers of a scene side by side.

#include "bench/core/frontier.hpp"

#include <algorithm>
#include <ctime>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hertzline::bench {

namespace {

/// Returns the processor time of this thread [s]: the wall time on an idle machine, and little more on a busy one.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Repeats a run for a few milliseconds. The first of several short runs warms up the caches and is not counted.
void time_runs(const Contender& contender, Trace& trace, std::vector<double>& times) {
    constexpr double enough_s = 3e-3;
    const double begin = processor_time();
    double before = begin;
    for (int run = 0; run == 0 || before - begin < enough_s; ++run) {
        contender.run(trace);
        const double now = processor_time();
        if (run > 0 || now - before > enough_s) {
            times.push_back(now - before);
        }
        before = now;
    }
}

std::vector<Contender> all_contenders(const Scene& scene, const Problem& problem) {
    std::vector<Contender> all;
    for (std::vector<Contender>& some : std::vector{hertzline_contenders(scene), odeint_contenders(problem),
                                                    odeint_located_contenders(problem),
                                                    cvode_contenders(problem), arkode_contenders(problem)}) {
        std::ranges::move(some, std::back_inserter(all));
    }
    std::ranges::stable_sort(all, {}, [](const Contender& c) { return std::pair(c.kind, c.name); });
    return all;
}

}  // namespace

double Result::error() const {
    return failure.empty() ? std::max({error_v_last, error_v_plate, error_v_out})
                           : std::numeric_limits<double>::infinity();
}

Field::Field(const std::string& reference)
    : reference_(test::read_reference(reference)),
      problem_(problem(test::reference_scene(reference), reference_.v_last.size())),
      contenders_(all_contenders(test::reference_scene(reference), problem_)) {}

double Field::simulated_s() const {
    return static_cast<double>(problem_.samples - 1) * problem_.sample_period * 1e-6;
}

Result Field::answer(const Contender& contender, Trace& trace) const {
    Result result{
        .kind = contender.kind, .solver = contender.name, .setting = contender.setting, .failure = {}};
    try {
        contender.run(trace);
    } catch (const std::runtime_error& error) {
        result.failure = error.what();
        return result;
    }
    result.error_v_last = test::relative_l2(trace.v_last, reference_.v_last);
    if (problem_.plate) {
        result.error_v_plate = test::relative_l2(trace.v_plate, reference_.v_plate);
        result.error_v_out = test::relative_l2(trace.v_out, reference_.v_out);
    }
    return result;
}

std::vector<Result> Field::measure(int rounds) const {
    Trace trace(problem_);
    std::vector<Result> results;
    for (const Contender& contender : contenders_) {
        results.push_back(answer(contender, trace));
    }
    std::vector<std::vector<double>> times(contenders_.size());
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < contenders_.size(); ++i) {
            if (results[i].failure.empty()) {
                time_runs(contenders_[i], trace, times[i]);
            }
        }
    }
    for (std::size_t i = 0; i < contenders_.size(); ++i) {
        if (!times[i].empty()) {
            std::ranges::sort(times[i]);
            results[i].median_s = times[i][times[i].size() / 2];
            results[i].fastest_s = times[i].front();
        }
    }
    return results;
}

std::optional<Result> Field::tightest(const std::string& solver) const {
    const auto found = std::ranges::find(contenders_.rbegin(), contenders_.rend(), solver, &Contender::name);
    if (found == contenders_.rend()) {
        return {};
    }
    Trace trace(problem_);
    return answer(*found, trace);
}

const Result* fastest(const std::vector<Result>& results, const std::vector<Kind>& kinds, double bound,
                      Judged judged) {
    const Result* best = nullptr;
    for (const Result& result : results) {
        const double error =
            judged == Judged::by_v_last && result.failure.empty() ? result.error_v_last : result.error();
        if (error <= bound && std::ranges::count(kinds, result.kind) > 0 &&
            (best == nullptr || result.median_s < best->median_s)) {
            best = &result;
        }
    }
    return best;
}

}  // namespace hertzline::bench
