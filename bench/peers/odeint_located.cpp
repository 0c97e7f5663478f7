// Boost.odeint's dopri5 with located contacts, as a careful user would build it around the dense output. The set of
// closed contacts stays fixed over a step. If a contact has opened or closed at the end of the step, the crossing is
// found in the dense output, and the integration restarts there.

#include <boost/numeric/odeint.hpp>

#include "bench/peers/sampling.hpp"

namespace hertzline::bench {

namespace {

namespace odeint = boost::numeric::odeint;

template <std::size_t Lanes>
class LocatedDopri5 {
public:
    LocatedDopri5(const Problem& problem, double tolerance)
        : problem_(problem),
          equations_(problem),
          stepper_(
              odeint::make_dense_output(tolerance, tolerance, odeint::runge_kutta_dopri5<State<Lanes>>())) {}

    void operator()(Trace& trace) {
        SampleRecorder<Lanes> recorder(problem_, trace);
        const auto system = [this](const State<Lanes>& state, State<Lanes>& slope, double t) {
            equations_.derivative(state.data(), slope.data(), t);
        };
        State<Lanes> state{};
        equations_.close_all();
        stepper_.initialize(state, 0.0, first_step);
        int restarts = 0;
        while (!recorder.done()) {
            stepper_.do_step(system);
            const Crossing crossing = first_crossing();
            while (!recorder.done() && recorder.next_time() <= crossing.time) {
                stepper_.calc_state(recorder.next_time(), state);
                recorder.put(state.data());
            }
            if (crossing.contact < problem_.contacts) {
                if (++restarts > max_restarts) {
                    throw std::runtime_error("stuck at a contact");
                }
                stepper_.calc_state(crossing.time, state);
                equations_.switch_contact(crossing.contact);
                stepper_.initialize(state, crossing.time, stepper_.current_time_step());
            }
        }
    }

private:
    struct Crossing {
        double time;
        std::size_t contact;  ///< problem.contacts: none
    };

    bool wrong(std::size_t contact, double distance) const {
        return equations_.closed(contact) ? distance < 0 : distance > 0;
    }

    Crossing first_crossing() {
        std::array<double, Lanes> distance;
        Crossing first{stepper_.current_time(), problem_.contacts};
        equations_.switching(stepper_.current_state().data(), distance.data(), first.time);
        for (std::size_t c = 0; c < problem_.contacts; ++c) {
            if (wrong(c, distance[c])) {
                const double time = crossing_time(c);
                if (time <= first.time) {
                    first = {time, c};
                }
            }
        }
        return first;
    }

    double switching_at(std::size_t contact, double t) {
        State<Lanes> state;
        std::array<double, Lanes> distance;
        stepper_.calc_state(t, state);
        equations_.switching(state.data(), distance.data(), t);
        return distance[contact];
    }

    /// Finds the crossing by the Illinois variant of the false-position method.
    double crossing_time(std::size_t contact) {
        double a = stepper_.previous_time();
        double b = stepper_.current_time();
        double at_a = switching_at(contact, a);
        double at_b = switching_at(contact, b);
        if (wrong(contact, at_a)) {
            return a;
        }
        double t = b;
        for (int i = 0; i < 60 && std::abs(b - a) > 1e-13 * std::abs(b) && at_b != at_a; ++i) {
            t = (a * at_b - b * at_a) / (at_b - at_a);
            const double at_t = switching_at(contact, t);
            if (std::abs(at_t) < 1e-15) {
                break;
            }
            if ((at_t > 0) == (at_b > 0)) {
                at_a /= 2;
            } else {
                a = b;
                at_a = at_b;
            }
            b = t;
            at_b = at_t;
        }
        return t;
    }

    const Problem& problem_;
    Equations<Lanes, Contacts::located> equations_;
    decltype(odeint::make_dense_output(0.0, 0.0, odeint::runge_kutta_dopri5<State<Lanes>>())) stepper_;
};

}  // namespace

Contender odeint_dopri5_located(const Problem& problem, double tolerance) {
    return {Kind::located, "odeint dopri5, located", tolerance_text(tolerance),
            with_lanes(problem, [&](auto lanes) -> std::function<void(Trace&)> {
                return LocatedDopri5<lanes()>(problem, tolerance);
            })};
}

std::vector<Contender> odeint_located_contenders(const Problem& problem) {
    std::vector<Contender> list;
    for (const double tolerance : tolerances(1e-2)) {
        list.push_back(odeint_dopri5_located(problem, tolerance));
    }
    return list;
}

}  // namespace hertzline::bench
