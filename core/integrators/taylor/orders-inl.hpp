// The series of the motion, order by order from the equations of motion. Included once per SIMD target.
#if defined(HERTZLINE_ORDERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_ORDERS_INL
#undef HERTZLINE_ORDERS_INL
#else
#define HERTZLINE_ORDERS_INL
#endif

#include <utility>

#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/taylor/clamped_law-inl.hpp"
#include "core/integrators/taylor/damping-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"
#include "core/integrators/taylor/plate-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Orders 0 and 1 of an overlap; whether the contact is closed; order 0 of its elastic force.
/// @returns contacts that have just closed
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Flags begin_contact(Expansion<K, Degree, Kind>& e, std::size_t k, Vec static_overlap) {
    constexpr double min_overlap = 1e-150;  // nothing above it overflows [m]
    const Vec d1 = e.rows.difference(e.x[1], k, e.piece.waves.slope);
    const Vec d0 = e.rows.difference(static_overlap, e.x[0], k, e.piece.waves.displacement);
    const Vec rounding_error = MulAdd(splat(at_zero<Kind>), Abs(d1), splat(e.piece.negligible));
    const Flags touching_only = Le(Abs(d0), rounding_error);
    const Flags closing = And(touching_only, Gt(d1, splat(standstill)));
    e.d[0].set(k, IfThenZeroElse(touching_only, d0));
    e.d[1].set(k, d1);
    const Flags overlaps = Or(closing, Gt(e.d[0][k], zero()));
    const Flags elastic = AndNot(closing, overlaps);
    e.onset.set(k, one_where(closing));
    e.deflated.set(k, one_where(touching_only));
    e.overlaps.set(k, one_where(overlaps));
    // root and quotient take long: they do not wait for the state of the contact
    const Vec delta = Max(d0, splat(min_overlap));
    e.per_overlap.set(k, IfThenElseZero(elastic, splat(1.0) / delta));
    e.u[0].set(k, IfThenElseZero(elastic, hertz(e.stiffness[k], delta)));  // [N] here, scaled later
    return closing;
}

/// Orders 0 and 1 of displacements and overlaps, and the factors that all higher orders share.
/// @returns whether a contact has just closed.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE bool begin(Expansion<K, Degree, Kind>& e) {
    const Vec unit = splat(e.piece.unit_s);
    const Col<K> static_overlap = e.rows.load(ChainField::static_overlap);
    const Col<K> damping = e.rows.load(ChainField::damping);
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        e.x[0].set(k, e.x_now[k]);
        e.x[1].set(k, unit * e.v_now[k]);
    }
    Flags any_onset = none();
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        any_onset = Or(any_onset, begin_contact(e, k, static_overlap[k]));
    }
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        e.closed.set(k, e.overlaps[k]);
        const Vec damping_now = damping_at(e, damping[k], e.d[0][k]);
        if (HWY_UNLIKELY(e.clamped)) {
            e.closed.set(k, pushing(e, k, damping_now));
        }
        e.decay.set(k, unit * (e.closed[k] * damping_now));
        e.mobility_left.set(k, e.rows.left(e.inv_mass, k));
        e.mobility.set(k, e.inv_mass[k] + e.mobility_left[k]);
        e.ground.set(k, splat(e.square) * e.rows.left(e.spring, k));
    }
    const bool onset = any(any_onset);
    e.piece.onset = onset;
    return onset;
}

/// Adds the product of orders J and N - J to the sum for the elastic force's order N.
template <int N, int J, std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec with_product(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec sum) {
    constexpr double weight = (1.5 * (N - J) - J) / N;
    if constexpr (weight == 0) {
        return sum;
    } else {
        return MulAdd(splat(weight) * e.u[J][k], e.d[N - J][k], sum);
    }
}
/// Sum of the products with both orders at least J. The highest orders are known last: they are added last.
template <int N, int J, std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec products(const Expansion<K, Degree, Kind>& e, std::size_t k) {
    if constexpr (2 * J > N) {
        return zero();
    } else if constexpr (2 * J == N) {
        return with_product<N, J>(e, k, zero());
    } else {
        return with_product<N, N - J>(e, k, with_product<N, J>(e, k, products<N, J + 1>(e, k)));
    }
}
/// The elastic force's coefficient of order N without the term of the overlap's.
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec elastic_by_products(const Expansion<K, Degree, Kind>& e, std::size_t k) {
    if constexpr (N == 1) {
        return zero();
    } else {
        return products<N, 1>(e, k) * e.per_overlap[k];
    }
}

/// Half the force of order 0, times unit^2, without the dashpots. The spring behind the last body is the
/// force of a contact to its right, in the slot of a pad.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec first_force(const Expansion<K, Degree, Kind>& e, std::size_t k) {
    const Vec half_square = splat(0.5 * e.square);
    const Vec elastic = HWY_UNLIKELY(e.clamped) ? e.closed[k] * e.u[0][k] : e.u[0][k];
    const Vec bias = half_square * e.rows.left(e.rows.load(ChainField::bias), k);
    const Vec half_ground = splat(0.5) * e.ground[k];
    const Vec behind = MulSub(half_ground, e.rows.left(e.x[0], k), bias);
    return MulAdd(half_square, elastic - e.static_force[k], behind);
}
/// Order N of the terms that depend on the overlap: elastic force, and spring behind the last body.
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec force_of_place(Expansion<K, Degree, Kind>& e, std::size_t k) {
    const Vec bent = elastic_by_products<N>(e, k);
    e.u[N].set(k, MulAdd(e.elastic_slope[k], e.d[N][k], bent));
    if (HWY_UNLIKELY(e.clamped)) {
        return MulAdd(e.ground[k], e.d[N][k], e.closed[k] * e.u[N][k]);
    }
    return MulAdd(e.ground[k] + e.elastic_slope[k], e.d[N][k], bent);
}
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec share_of_place(Expansion<K, Degree, Kind>& e, std::size_t k) {
    if constexpr (N == 0) {
        return first_force(e, k);
    } else {
        return splat(1.0 / ((N + 1) * (N + 2))) * force_of_place<N>(e, k);
    }
}

template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void prepare_higher_orders(Expansion<K, Degree, Kind>& e) {
    const Vec square = splat(e.square);
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        if (HWY_UNLIKELY(e.clamped)) {
            settle_grazing_force(e, k);
        }
        e.u[0].set(k, square * e.u[0][k]);
        e.elastic_slope.set(k, splat(1.5) * (e.u[0][k] * e.per_overlap[k]));
    }
}

/// The holder's force in order N + 2, by the velocities' order N.
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE void hold(Expansion<K, Degree, Kind>& e) {
    Col<K> slowing = e.rows.scratch(Expansion<K, Degree, Kind>::Scratch::slowing);
    const Col<K> drag = e.rows.load(ChainField::drag);
    const Vec share = splat(e.piece.unit_s / (N + 2));
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        slowing.set(k, share * (e.inv_mass[k] * drag[k]) * e.x[N + 1][k]);
        e.x[N + 2].set(k, e.x[N + 2][k] - slowing[k]);
    }
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        e.d[N + 2].set(k, e.d[N + 2][k] - e.rows.difference(slowing, k, 0.0));
    }
}

/// The tip's displacement of order N + 2, on which the first contact's force of order N acts back.
template <int N>
HWY_NOINLINE void move_tip(SeriesPiece& piece, double force) {
    HornTip& tip = *piece.tip;
    auto& own = tip.own;
    own[N + 2] =
        (tip.square * (tip.forcing[N] - own[N]) - tip.decay * (N + 1) * own[N + 1]) / ((N + 1) * (N + 2)) -
        tip.inv_mass * force;
    piece.horn[N + 2] += own[N + 2];
}

/// The forces of order N, and from them displacements and overlaps of order N + 2. Each order waits for the
/// overlaps of the one before, so the way from these to the next ones is kept short.
template <bool Held, int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE void order(Expansion<K, Degree, Kind>& e) {
    Col<K> force = e.rows.scratch(Expansion<K, Degree, Kind>::Scratch::force);
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        Vec of_place = share_of_place<N>(e, k);
        if constexpr (Kind == Damping::nonlinear) {
            of_place = MulAdd(splat(1.0 / (N + 2)), expand_damping<N + 1>(e, k), of_place);
        }
        const Vec decay = splat(1.0 / (N + 2)) * e.decay[k];
        force.set(k, MulAdd(decay, e.d[N + 1][k], of_place));
    }
    if (HWY_UNLIKELY(e.piece.plate != nullptr)) {
        exchange_with_plate<N>(e, force);
    }
    if (HWY_UNLIKELY(e.piece.tip != nullptr)) {
        move_tip<N>(e.piece, in_first_contact(force));
    }
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        const Vec right = e.rows.right(force, k);
        e.x[N + 2].set(k, e.inv_mass[k] * (force[k] - right));
        const Vec horn = k == 0 ? e.rows.horn(e.piece.horn[N + 2]) : zero();
        const Vec from_self = NegMulAdd(e.mobility[k], force[k], horn);
        const Vec from_right = MulAdd(e.inv_mass[k], right, from_self);
        e.d[N + 2].set(k, MulAdd(e.mobility_left[k], e.rows.left(force, k), from_right));
    }
    if constexpr (Held) {
        hold<N>(e);
    }
    if constexpr (N == 0) {
        prepare_higher_orders(e);
    }
}
template <bool Held, std::size_t K, int Degree, Damping Kind, int... N>
HWY_INLINE void orders(Expansion<K, Degree, Kind>& e, std::integer_sequence<int, N...>) {
    (order<Held, N>(e), ...);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
