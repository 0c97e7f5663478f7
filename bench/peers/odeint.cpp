// Unmodified Boost.odeint: adaptive methods with dense output, and fixed steps that divide the sample period.

#include <boost/numeric/odeint.hpp>

#include "bench/peers/sampling.hpp"

namespace hertzline::bench {

namespace {

namespace odeint = boost::numeric::odeint;

template <std::size_t Lanes>
using Plain = Equations<Lanes, Contacts::by_overlap>;

template <std::size_t Lanes>
auto first_order(const Plain<Lanes>& equations) {
    return [&equations](const State<Lanes>& state, State<Lanes>& slope, double t) {
        equations.derivative(state.data(), slope.data(), t);
    };
}

template <std::size_t Lanes, class Stepper>
Contender dense(const Problem& problem, const char* name, double tolerance, Stepper stepper) {
    return {Kind::as_it_comes, name, tolerance_text(tolerance),
            [&problem, equations = Plain<Lanes>(problem), stepper](Trace& trace) mutable {
                SampleRecorder<Lanes> recorder(problem, trace);
                State<Lanes> state{};
                stepper.initialize(state, 0.0, first_step);
                while (!recorder.done()) {
                    stepper.do_step(first_order(equations));
                    while (!recorder.done() && recorder.next_time() <= stepper.current_time()) {
                        stepper.calc_state(recorder.next_time(), state);
                        recorder.put(state.data());
                    }
                }
            }};
}

/// Runs a method without dense output; steps end at the samples.
template <std::size_t Lanes, class Stepper>
Contender controlled(const Problem& problem, const char* name, double tolerance, Stepper fresh) {
    return {Kind::as_it_comes, name, tolerance_text(tolerance),
            [&problem, equations = Plain<Lanes>(problem), fresh](Trace& trace) {
                SampleRecorder<Lanes> recorder(problem, trace);
                State<Lanes> state{};
                Stepper stepper = fresh;
                double t = 0;
                double wanted = first_step;
                recorder.put(state.data());
                while (!recorder.done()) {
                    const double left = recorder.next_time() - t;
                    double step = std::min(wanted, left);
                    const bool cut = step < wanted;
                    const bool accepted =
                        stepper.try_step(first_order(equations), state, t, step) == odeint::success;
                    wanted = accepted && cut ? std::max(wanted, step) : step;
                    if (accepted && cut) {
                        t = recorder.next_time();
                        recorder.put(state.data());
                    }
                }
            }};
}

template <std::size_t Lanes>
Contender dopri5(const Problem& problem, double tolerance) {
    return dense<Lanes>(
        problem, "odeint dopri5", tolerance,
        odeint::make_dense_output(tolerance, tolerance, odeint::runge_kutta_dopri5<State<Lanes>>()));
}

std::string step_text(const Problem& problem, int steps_per_sample) {
    char text[32];
    std::snprintf(text, sizeof text, "step %.4g ns", problem.sample_period * 1e3 / steps_per_sample);
    return text;
}

template <std::size_t Lanes, class Stepper>
Contender fixed(const Problem& problem, const char* name, int steps_per_sample, Stepper fresh) {
    return {Kind::as_it_comes, name, step_text(problem, steps_per_sample),
            [&problem, equations = Plain<Lanes>(problem), steps_per_sample, fresh](Trace& trace) {
                SampleRecorder<Lanes> recorder(problem, trace);
                State<Lanes> state{};
                Stepper stepper = fresh;
                const double h = problem.sample_period / steps_per_sample;
                recorder.put(state.data());
                for (double step = 0; !recorder.done(); recorder.put(state.data())) {
                    for (int i = 0; i < steps_per_sample; ++i, ++step) {
                        stepper.do_step(first_order(equations), state, step * h, h);
                    }
                }
            }};
}

/// Makes the scheme of discrete-element codes: one force evaluation a step, dashpots lag by half a step.
template <std::size_t Lanes>
Contender verlet(const Problem& problem, int steps_per_sample) {
    using Half = std::array<double, Lanes>;
    return {Kind::as_it_comes, "odeint velocity_verlet", step_text(problem, steps_per_sample),
            [&problem, equations = Plain<Lanes>(problem), steps_per_sample](Trace& trace) {
                SampleRecorder<Lanes> recorder(problem, trace);
                std::pair<Half, Half> moving{};
                odeint::velocity_verlet<Half> stepper;
                const auto second_order = [&equations](const Half& x, const Half& v, Half& a, double t) {
                    equations.acceleration(x.data(), v.data(), a.data(), t);
                };
                const auto put = [&] {
                    State<Lanes> state;
                    std::ranges::copy(moving.first, state.begin());
                    std::ranges::copy(moving.second, state.begin() + Lanes);
                    recorder.put(state.data());
                };
                const double h = problem.sample_period / steps_per_sample;
                put();
                for (double step = 0; !recorder.done(); put()) {
                    for (int i = 0; i < steps_per_sample; ++i, ++step) {
                        stepper.do_step(second_order, moving, step * h, h);
                    }
                }
            }};
}

template <std::size_t Lanes>
std::vector<Contender> contenders(const Problem& problem) {
    using S = State<Lanes>;
    std::vector<Contender> list;
    for (const double tolerance : tolerances(1e-2)) {
        list.push_back(dopri5<Lanes>(problem, tolerance));
        const auto fehlberg =
            odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_fehlberg78<S>());
        list.push_back(controlled<Lanes>(problem, "odeint runge_kutta_fehlberg78", tolerance, fehlberg));
        odeint::bulirsch_stoer_dense_out<S> stoer(tolerance, tolerance);
        list.push_back(dense<Lanes>(problem, "odeint bulirsch_stoer", tolerance, stoer));
    }
    for (int steps_per_sample = 1; steps_per_sample <= 64; steps_per_sample *= 2) {
        list.push_back(fixed<Lanes>(problem, "odeint rk4", steps_per_sample, odeint::runge_kutta4<S>()));
        list.push_back(fixed<Lanes>(problem, "odeint adams_bashforth_moulton", steps_per_sample,
                                    odeint::adams_bashforth_moulton<5, S>()));
        list.push_back(verlet<Lanes>(problem, steps_per_sample));
    }
    return list;
}

}  // namespace

Contender odeint_dopri5(const Problem& problem, double tolerance) {
    return with_lanes(problem, [&](auto lanes) { return dopri5<lanes()>(problem, tolerance); });
}

std::vector<Contender> odeint_contenders(const Problem& problem) {
    return with_lanes(problem, [&](auto lanes) { return contenders<lanes()>(problem); });
}

}  // namespace hertzline::bench
