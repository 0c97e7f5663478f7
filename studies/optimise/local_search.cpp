#include "studies/optimise/local_search.hpp"

#include <cmath>
#include <span>
#include <utility>

#include <nlopt.hpp>

namespace hertzline::studies {

namespace {

/// What NLopt's function sees.
struct Replay {
    nlopt::opt& method;
    std::span<const double> answers;
    std::size_t next = 0;
    std::optional<std::vector<double>> question;

    static double call(unsigned dimensions, const double* place, double* /*gradient*/, void* replay) {
        auto& self = *static_cast<Replay*>(replay);
        if (self.next < self.answers.size()) {
            return self.answers[self.next++];
        }
        if (!self.question) {
            self.question.emplace(place, place + dimensions);
        }
        self.method.force_stop();
        return HUGE_VAL;
    }
};

}  // namespace

LocalSearch::LocalSearch(std::vector<double> start, double step) : start_(std::move(start)), step_(step) {}

std::optional<std::vector<double>> LocalSearch::question() const {
    const auto dimensions = static_cast<unsigned>(start_.size());
    if (dimensions == 0) {
        return std::nullopt;
    }
    nlopt::opt method(nlopt::LN_SBPLX, dimensions);
    Replay replay{method, answers_, 0, std::nullopt};
    method.set_min_objective(&Replay::call, &replay);
    method.set_lower_bounds(0);
    method.set_upper_bounds(1);
    method.set_initial_step(step_);
    method.set_xtol_abs(local_resolution);
    method.set_maxeval(static_cast<int>(max_answers(dimensions)));
    std::vector<double> place = start_;
    double merit = 0;
    try {
        method.optimize(place, merit);
    } catch (const nlopt::forced_stop&) {  // it has asked
    } catch (const nlopt::roundoff_limited&) {
        return std::nullopt;
    }
    return std::move(replay.question);
}

}  // namespace hertzline::studies
