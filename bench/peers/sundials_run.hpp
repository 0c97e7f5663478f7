#pragma once
// Code that CVODE and ARKODE share: the right-hand side behind SUNDIALS' callbacks, and a run through all samples
// with or without root finding on the contacts' overlaps.

#include <memory>
#include <stdexcept>
#include <string>

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include "bench/peers/sampling.hpp"

namespace hertzline::bench {

struct Freed {
    void operator()(SUNContext context) const { SUNContext_Free(&context); }
    void operator()(N_Vector vector) const { N_VDestroy(vector); }
};

/// Returns the flag. @throws std::runtime_error when a SUNDIALS function failed.
inline int checked(int flag, const char* what) {
    if (flag < 0) {
        throw std::runtime_error(std::string(what) + " returned " + std::to_string(flag));
    }
    return flag;
}

/// @tparam Method owns the integrator's memory: begin(y), restart(t, y), advance(until, y, t), which is true
/// when it stopped at roots, roots(found) and find_roots(count, function).
template <class Method, std::size_t Lanes, Contacts Way>
class SundialsRun {
public:
    template <class... Settings>
    explicit SundialsRun(const Problem& problem, Settings... settings)
        : problem_(problem), equations_(problem), context_(new_context()), y_(new_vector(context_.get())) {
        N_VEnableFusedOps_Serial(y_.get(), SUNTRUE);
        method_ = std::make_unique<Method>(y_.get(), context_.get(), this, slope, settings...);
        if constexpr (Way == Contacts::located) {
            method_->find_roots(static_cast<int>(problem.contacts), switching);
        }
    }

    void operator()(Trace& trace) {
        SampleRecorder<Lanes> recorder(problem_, trace);
        equations_.close_all();
        N_VConst(0, y_.get());
        method_->begin(y_.get());
        recorder.put(state());
        int restarts = 0;
        while (!recorder.done()) {
            double t = 0;
            if (method_->advance(recorder.next_time(), y_.get(), t)) {
                if (++restarts > max_restarts) {
                    throw std::runtime_error("stuck at a contact");
                }
                switch_contacts();
                method_->restart(t, y_.get());
            } else {
                recorder.put(state());
            }
        }
    }

private:
    static auto new_context() {
        SUNContext context = nullptr;
        checked(SUNContext_Create(nullptr, &context), "SUNContext_Create");
        return std::unique_ptr<std::remove_pointer_t<SUNContext>, Freed>(context);
    }
    static auto new_vector(SUNContext context) {
        return std::unique_ptr<std::remove_pointer_t<N_Vector>, Freed>(N_VNew_Serial(2 * Lanes, context));
    }

    const double* state() const { return NV_DATA_S(y_.get()); }

    void switch_contacts() {
        std::array<int, Lanes> found{};  // 1: its overlap rose through zero, -1: it fell
        method_->roots(found.data());
        for (std::size_t c = 0; c < problem_.contacts; ++c) {
            if (found[c] != 0 && (found[c] > 0) != equations_.closed(c)) {
                equations_.switch_contact(c);
            }
        }
    }

    static int slope(double t, N_Vector y, N_Vector result, void* run) {
        static_cast<SundialsRun*>(run)->equations_.derivative(NV_DATA_S(y), NV_DATA_S(result), t);
        return 0;
    }
    static int switching(double t, N_Vector y, double* result, void* run) {
        auto* self = static_cast<SundialsRun*>(run);
        std::array<double, Lanes> all{};
        self->equations_.switching(NV_DATA_S(y), all.data(), t);
        std::copy_n(all.begin(), self->problem_.contacts, result);
        return 0;
    }

    const Problem& problem_;
    Equations<Lanes, Way> equations_;
    std::unique_ptr<std::remove_pointer_t<SUNContext>, Freed> context_;
    std::unique_ptr<std::remove_pointer_t<N_Vector>, Freed> y_;
    std::unique_ptr<Method> method_;
};

/// Makes a solver of that method, with contacts by overlap or located.
template <class Method, class... Settings>
Contender sundials_contender(const Problem& problem, const std::string& name, double tolerance,
                             Contacts contacts, Settings... settings) {
    const bool located = contacts == Contacts::located;
    const auto make = [&](auto lanes) -> std::function<void(Trace&)> {
        const auto prepared = [&]<Contacts Way>() -> std::function<void(Trace&)> {
            auto run = std::make_shared<SundialsRun<Method, lanes(), Way>>(problem, tolerance, settings...);
            return [run](Trace& trace) { (*run)(trace); };
        };
        return located ? prepared.template operator()<Contacts::located>()
                       : prepared.template operator()<Contacts::by_overlap>();
    };
    return {located ? Kind::located : Kind::as_it_comes, name + (located ? ", located" : ""),
            tolerance_text(tolerance), with_lanes(problem, make)};
}

}  // namespace hertzline::bench
