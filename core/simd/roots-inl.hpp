// Roots between two bounds, lane by lane. Included once per SIMD target.
#if defined(HERTZLINE_ROOTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_ROOTS_INL
#undef HERTZLINE_ROOTS_INL
#else
#define HERTZLINE_ROOTS_INL
#endif

#include "core/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Where a root lies.
struct Bracket {
    Vec low, high;
    HWY_INLINE Vec middle() const { return splat(0.5) * (low + high); }
    HWY_INLINE void narrow(Vec z, Flags beyond) {
        high = IfThenElse(beyond, z, high);
        low = IfThenElse(beyond, low, z);
    }
};

/// Halves a bracket until rounding stops it. @param beyond returns whether the change lies before z
template <class Beyond>
HWY_INLINE Bracket bisect(const Beyond& beyond, Vec high) {
    constexpr int halvings = 45;
    Bracket bracket{zero(), high};
    for (int i = 0; i < halvings; ++i) {
        const Vec z = bracket.middle();
        bracket.narrow(z, beyond(z));
    }
    return bracket;
}

/// Start of Newton's method, and when it ends.
struct Newton {
    Vec guess;
    Vec high;       ///< the root lies between 0 and this
    Flags rising;   ///< the function is positive behind its root
    Vec tolerance;  ///< a smaller change is the last: the error is its square
    Flags wanted;   ///< lanes that are waited for
    int max_rounds;
};

/// Root of a function by Newton's method kept inside its bracket. @param function (z, slope) -> value, sets the slope
template <class Function>
HWY_INLINE Vec bracketed_newton(const Function& function, const Newton& start) {
    Vec z = start.guess;
    Bracket bracket{zero(), start.high};
    for (int i = 0; i < start.max_rounds; ++i) {
        Vec slope;
        const Vec value = function(z, slope);
        bracket.narrow(z, Not(Xor(Gt(value, zero()), start.rising)));
        const Vec newton = z - value / slope;
        // the ends count as inside: a converged iterate stays where it is
        const Flags inside = And(hn::Ge(newton, bracket.low), Le(newton, bracket.high));
        const Vec next = IfThenElse(inside, newton, bracket.middle());
        const Flags settled = Le(Abs(next - z), start.tolerance);
        z = next;
        if (all(Or(settled, Not(start.wanted)))) {
            break;
        }
    }
    return z;
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
