#pragma once
// Code that the peers share around the right-hand side: the chain's size as a compile-time constant, and the samples.

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/peers/equations.hpp"

namespace hertzline::bench {

/// Calls `use` with the number of lanes as a compile-time constant.
template <class Use>
auto with_lanes(const Problem& problem, Use use) {
    if (problem.bodies < 8) {
        return use(std::integral_constant<std::size_t, 8>{});
    }
    if (problem.bodies < 16) {
        return use(std::integral_constant<std::size_t, 16>{});
    }
    throw std::invalid_argument("the peers simulate chains of at most 15 bodies");
}

/// Records states as samples.
template <std::size_t Lanes>
class SampleRecorder {
public:
    SampleRecorder(const Problem& problem, Trace& trace) : problem_(problem), trace_(trace) {}

    bool done() const { return next_ == problem_.samples; }
    /// Returns the time of the next sample [us], computed from its index.
    double next_time() const { return static_cast<double>(next_) * problem_.sample_period; }

    void put(const double* state) {
        const std::size_t last = problem_.last_sphere;
        const double v_last = state[Lanes + last] * problem_.velocity_unit;
        trace_.v_last[next_] = v_last;
        if (problem_.plate) {
            const double overlap = problem_.static_overlap[last + 1] + state[last] - state[last + 1];
            const double v_plate = state[Lanes + last + 1] * problem_.velocity_unit;
            trace_.v_plate[next_] = v_plate;
            trace_.v_out[next_] = (overlap > 0 ? v_last * problem_.transmission : 0) + v_plate;
        }
        ++next_;
    }

private:
    const Problem& problem_;
    Trace& trace_;
    std::size_t next_ = 0;
};

/// Returns the tolerances of all adaptive peers, from `loosest` on.
inline std::vector<double> tolerances(double loosest) {
    std::vector<double> list;
    for (double tolerance = loosest; tolerance > 0.9e-12; tolerance /= std::sqrt(10.0)) {
        list.push_back(tolerance);
    }
    return list;
}

inline std::string tolerance_text(double tolerance) {
    char text[32];
    std::snprintf(text, sizeof text, "tolerance %.1e", tolerance);
    return text;
}

/// A run with more restarts at contacts than this is stuck at one.
inline constexpr int max_restarts = 100'000;

/// First step that adaptive solvers try [us].
inline constexpr double first_step = 0.01;

}  // namespace hertzline::bench
