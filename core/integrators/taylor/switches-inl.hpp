// Contacts that open or close within a piece, and when. Included once per SIMD target.
#if defined(HERTZLINE_SWITCHES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_SWITCHES_INL
#undef HERTZLINE_SWITCHES_INL
#else
#define HERTZLINE_SWITCHES_INL
#endif

#include <algorithm>
#include <array>

#include "core/integrators/taylor/clamped_law-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"
#include "core/simd/roots-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Contacts that have switched between the start and z.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Flags switches(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec z) {
    const Vec limit = IfThenElseZero(e.open(k), splat(e.piece.negligible));
    const Flags overlaps = Gt(value_at(e.d, k, z), limit);
    Flags changed = Xor(overlaps, Gt(e.overlaps[k], zero()));
    if (HWY_UNLIKELY(e.clamped)) {
        // a contact that has just closed pushes, although its elastic force is not in the series
        const Flags onset = Gt(e.onset[k], zero());
        const Flags pad = Eq(e.stiffness[k], zero());
        const Flags pushes = And(overlaps, Or(onset, would_push(e, k, z)));
        changed = Or(changed, AndNot(pad, Xor(pushes, Gt(e.closed[k], zero()))));
    }
    return changed;
}

template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE bool any_switch(const Expansion<K, Degree, Kind>& e, double length) {
    const Vec z = splat(length);
    Flags found = none();
    Flags approach = found;
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        found = Or(found, switches(e, k, z));
        approach = Or(approach, And(e.open(k), Gt(e.d[1][k], zero())));
    }
    if (any(approach)) {
        // an open contact that approached and withdraws again may have touched in between
        HERTZLINE_EACH_ROW(k, e.rows.count()) {
            const Flags turned = And(Gt(e.d[1][k], zero()), Lt(slope_at(e.d, k, z), zero()));
            found = Or(found, And(e.open(k), turned));
        }
    }
    return any(found);
}

/// A contact without tension may let go and push again within a piece: an eighth of the length in which one
/// does, or all of it.
template <std::size_t K, int Degree, Damping Kind>
HWY_NOINLINE double until_a_switch(const Expansion<K, Degree, Kind>& e, double length) {
    constexpr int parts = 8;
    for (int part = 1; part < parts; ++part) {
        const double z = length * part / parts;
        HERTZLINE_EACH_ROW(k, e.rows.count()) {
            if (any(switches(e, k, splat(z)))) {
                return z;
            }
        }
    }
    return length;
}

/// Where an open contact that withdraws at `end` came nearest; `end` for all others and for those that did
/// not touch then.
template <std::size_t K, std::size_t Size>
HWY_INLINE Vec turning_point(const std::array<Col<K>, Size>& d, std::size_t k, Flags open, double negligible,
                             Vec end) {
    const Vec limit = splat(negligible);
    const Flags apart = Le(value_at(d, k, end), limit);
    const Flags turned = And(Gt(d[1][k], zero()), Lt(slope_at(d, k, end), zero()));
    const Flags concerned = And(And(open, apart), turned);
    if (!any(concerned)) {
        return end;
    }
    const auto withdrawing = [&](Vec z) HWY_ATTR { return Not(Gt(slope_at(d, k, z), zero())); };
    const Vec nearest = bisect(withdrawing, end).low;
    const Flags touched = And(concerned, Gt(value_at(d, k, nearest), limit));
    return IfThenElse(touched, nearest, end);
}

/// The series by which contacts close and open. A copy: nothing that has its address taken stays in registers.
template <std::size_t K, int Degree>
struct Overlaps {
    template <Damping Kind>
    HWY_INLINE explicit Overlaps(const Expansion<K, Degree, Kind>& e)
        : rows(e.rows), d(e.d), overlaps(e.overlaps), deflated(e.deflated) {}
    StripedRows<K> rows;
    Series<K, Degree> d;
    Col<K> overlaps;
    Col<K> deflated;
};

/// Fraction of the way at which the cubic through both ends of the inverse function is zero. @param rise of
/// the function, from, to: its slopes at both ends
HWY_INLINE Vec inverse_cubic(Vec start, Vec rise, Vec from, Vec to) {
    const Vec t = Neg(start) / rise;
    const Vec rest = splat(1.0) - t;
    const Vec straight = t * t * (splat(3.0) - (t + t));
    const Vec bend = t * rest * MulSub(rise / from, rest, rise / to * t);
    return straight + bend;
}

/// Root of the overlap between 0 and `end`. A root at 0 itself, of a contact that has just switched, is divided out.
template <std::size_t K, int Degree>
HWY_INLINE Vec crossing(const Overlaps<K, Degree>& contacts, std::size_t k, Vec end, Flags wanted) {
    constexpr int max_rounds = 8;
    const Flags deflated = Gt(contacts.deflated[k], zero());
    std::array<Vec, Degree + 1> c;
    for (int n = 0; n < Degree; ++n) {
        c[n] = IfThenElse(deflated, contacts.d[n + 1][k], contacts.d[n][k]);
    }
    c[Degree] = IfThenZeroElse(deflated, contacts.d[Degree][k]);
    const auto overlap = [&](Vec z, Vec& slope) HWY_ATTR {
        Vec value = c[Degree];
        slope = zero();
        for (int n = Degree - 1; n >= 0; --n) {
            slope = MulAdd(slope, z, value);
            value = MulAdd(value, z, c[n]);
        }
        return value;
    };
    Vec slope;
    const Vec at_end = overlap(end, slope);
    const Vec guess = inverse_cubic(c[0], at_end - c[0], end * c[1], end * slope);
    const Flags sound = And(Gt(guess, zero()), Lt(guess, splat(1.0)));
    return bracketed_newton(overlap, {.guess = end * IfThenElse(sound, guess, splat(0.5)),
                                      .high = end,
                                      .rising = Gt(at_end, zero()),
                                      .tolerance = splat(1e-8) * end,
                                      .wanted = wanted,
                                      .max_rounds = max_rounds});
}

/// The first moment at which a contact opens or closes. Contacts that do so within the shortest piece do so together.
template <std::size_t K, int Degree>
HWY_NOINLINE double first_crossing(const Overlaps<K, Degree>& contacts, double negligible, double length) {
    Vec first = splat(length);
    HERTZLINE_EACH_ROW(k, contacts.rows.count()) {
        const Flags open = Eq(contacts.overlaps[k], zero());
        const Vec end = turning_point(contacts.d, k, open, negligible, splat(length));
        const Vec limit = IfThenElseZero(open, splat(negligible));
        const Flags changed = Not(Xor(open, Gt(value_at(contacts.d, k, end), limit)));
        const Vec when = crossing(contacts, k, end, changed);
        first = Min(first, IfThenElse(changed, when, splat(length)));
    }
    return std::max(smallest_lane(first), shortest);
}

/// The same for contacts without tension, whose total force decides: it has no simple slope.
template <std::size_t K, int Degree, Damping Kind>
HWY_NOINLINE double first_clamped_switch(const Expansion<K, Degree, Kind>& e, double length) {
    Vec first = splat(length);
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        const Vec end = turning_point(e.d, k, e.open(k), e.piece.negligible, splat(length));
        const auto switched = [&](Vec z) HWY_ATTR { return switches(e, k, z); };
        const Vec when = bisect(switched, end).high;
        first = Min(first, IfThenElse(switches(e, k, end), when, splat(length)));
    }
    return std::max(smallest_lane(first), shortest);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
