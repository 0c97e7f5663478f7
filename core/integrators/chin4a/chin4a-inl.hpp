// Chin's forward fourth-order algorithm 4A with located contacts.
//
//     V/6, A/2, 2V~/3, A/2, V/6        S. A. Chin, Phys. Lett. A 226 (1997) 344;
//                                      time-dependent forces: S. A. Chin and C. R. Chen, astro-ph/0304223
//
// V kicks by the elastic forces, the plate's spring and the horn's part of the first dashpot, all functions
// of position and time. A drifts: positions by velocities, velocities by the dashpots, a linear flow that is
// exact up to its fifth power (the dashpots' decay over a step is small), which keeps the method fourth order
// with damping. V~ adds the force gradient h^2/48 grad |F|^2/m, which needs the tangent stiffness only. All
// coefficients are positive: no step backward.
//
// All this holds while the set of closed contacts stays the same, so the set is frozen during a step. A
// step at whose end a contact is found on the wrong side is taken again up to the crossing, the contact is
// switched, and the rest of the step follows. A kick corrects the error of Simpson's rule about that moment.
// The horn's motion is smooth only piecewise; where a piece ends inside a step the step is split, too.
#if defined(HERTZLINE_CHIN4A_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_CHIN4A_INL
#undef HERTZLINE_CHIN4A_INL
#else
#define HERTZLINE_CHIN4A_INL
#endif

#include "core/integrators/chin4a/chin4a_chain-inl.hpp"
#include "core/integrators/chin4a/crossings-inl.hpp"
#include "core/integrators/chin4a/frozen_step-inl.hpp"
#include "core/integrators/chin4a/whole_drift-inl.hpp"
#include "core/integrators/simd/record-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// One step of a chain whose contacts stay as they are, from now to next.
/// @returns whether they did; if not, next is void.
template <std::size_t K>
HWY_INLINE bool try_step(Chin4aChain<K>& chin, const WholeDrift<K>& half_drift, const HornMotion& middle,
                         const HornMotion& end) {
    frozen_step(chin, chin.h, half_drift, middle, end);
    return !any_crosses(chin, end);
}

/// A step in which a contact switches or the horn's motion has a break. Works from and to the chain's memory.
template <std::size_t K>
HWY_NOINLINE void take_split_step(SimdChain& chain, const Horn& prescribed, const HornStep& horn,
                                  std::int64_t step, Trial trial, Trace& trace) {
    Chin4aChain<K> chin(chain);
    double from = 0;
    while (from < 1) {
        const double to = horn.breaks ? prescribed.next_break(step, from) : 1;
        const double inside = 0.5 * (from + to);
        const HornMotion begin = horn.breaks ? prescribed.at(step, from, inside) : horn.start;
        const HornMotion end = horn.breaks ? prescribed.at(step, to, inside) : horn.end;
        const auto record_row = [&](double fraction_of_part) HWY_ATTR {
            if (trace.between && trace.count + 2 < trace.capacity) {
                chin.save_motion();
                record(chain, trace, step, from + fraction_of_part * (to - from));
            }
        };
        if (horn.fresh || from > 0) {
            if (from > 0) {
                record_row(0);
            }
            add_work_of_jump(chin, begin);
            rebuild(chin, begin);
            record_row(0);
        }
        advance_located(chin, HornCurve(begin, end, (to - from) * chain.step_s), trial, record_row);
        from = to;
    }
    chin.save();
}

template <std::size_t K>
int advance_chin4a(SimdChain& chain, const Horn& prescribed, const HornStep* horn, std::int64_t first,
                   int count, Trace& trace) {
    Chin4aChain<K> chin(chain);
    if (chain.rebuild) {
        rebuild(chin, horn[0].start);
        chain.rebuild = false;
    }
    WholeDrift<K> half_drift(chin);
    int taken = 0;
    while (taken < count && trace.has_room()) {
        const HornStep& now = horn[taken];
        const bool smooth = !now.fresh && !now.breaks;
        if (HWY_LIKELY(smooth && try_step(chin, half_drift, now.middle, now.end))) {
            accept(chin, chain.step_s);
        } else {
            chin.save();
            chin.save_trial();
            take_split_step<K>(chain, prescribed, now, first + taken,
                               smooth ? Trial::crossed : Trial::not_yet, trace);
            chin = Chin4aChain<K>(chain);
            half_drift = WholeDrift<K>(chin);
        }
        ++taken;
        if (trace.next == first + taken) {
            chin.save_motion();
            record(chain, trace, first + taken, 0);
        }
    }
    chin.save();
    return taken;
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
