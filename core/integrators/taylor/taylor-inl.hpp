// Taylor series of the motion, with located contacts.
//
// Between openings and closings of contacts the motion is analytic. Its series about the present follows from
// the equations of motion order by order; that of Hertz's law u = delta^(3/2) from delta u' = 3/2 delta' u,
// so that no derivative is ever formed by hand:
//
//     n delta_0 u_n = sum_{j<n} (3/2 (n - j) - j) delta_{n-j} u_j
//
//     (the power rule for series, D. E. Knuth, The Art of Computer Programming 2, section 4.7; the method:
//     A. Jorba and M. Zou, Experimental Mathematics 14 (2005) 99)
//
// A piece is as long as its last coefficients allow; the series is its own dense output, for samples and for
// the moment at which a contact switches: there the piece ends, nothing is taken twice.
//
// Hertz's law has a branch point where a contact opens or closes. Before an opening the pieces shorten by
// themselves, since the coefficients show how near it is. At a closing delta_0 = 0 and there is no series of
// delta^(3/2) in whole powers: for a first short piece the contact's dashpot is part of the expansion and
// its elastic force, k (w t)^(3/2) (1 + ...), is integrated term by term and added.
//
// Damping forces with a power of the overlap (damping-inl.hpp) are expanded as the elastic force is, and at a
// closing are integrated with it.
//
// Which contacts are closed is never remembered: at the start of a piece a contact is closed if it overlaps,
// or, within rounding of zero overlap, if it is closing.
#if defined(HERTZLINE_TAYLOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_TAYLOR_INL
#undef HERTZLINE_TAYLOR_INL
#else
#define HERTZLINE_TAYLOR_INL
#endif

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/integrators/series_piece.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"
#include "core/integrators/taylor/horn_series-inl.hpp"
#include "core/integrators/taylor/ledger-inl.hpp"
#include "core/integrators/taylor/onset-inl.hpp"
#include "core/integrators/taylor/orders-inl.hpp"
#include "core/integrators/taylor/switches-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

constexpr double least_places = 8;  // of the plate's grid in a piece that is shortened to it

/// How far the series can be trusted [z].
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE double trusted_length(Expansion<K, Degree, Kind>& e, bool onset) {
    Vec last = zero();
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        const Vec half_before = splat(0.5) * Abs(e.x[Degree - 1][k]);
        last = Max(last, Max(Abs(e.x[Degree][k]), half_before));
    }
    e.piece.largest = largest_lane(last);
    if (HWY_UNLIKELY(e.piece.tip != nullptr)) {
        const HornTip& tip = *e.piece.tip;
        e.piece.largest =
            std::max({e.piece.largest, std::abs(tip.own[Degree]), 0.5 * std::abs(tip.own[Degree - 1])});
    }
    const double error = Degree * e.piece.largest + 1e-300;
    double length = rough_power(e.piece.tolerance, error, 1, Degree - 1);
    if (HWY_UNLIKELY(onset)) {
        length = std::min(length, onset_length(e));
    }
    length = std::max(length, shortest);
    if (length >= e.piece.reach) {
        return e.piece.reach;
    }
    if (HWY_UNLIKELY(e.piece.plate != nullptr) && length * PlateMotion::grid > least_places) {
        // to where the plate's states can be looked up
        length = static_cast<double>(static_cast<int>(length * PlateMotion::grid)) / PlateMotion::grid;
    }
    return length;
}

/// Horner's rule for value and slope of displacements together, terms N down to Last.
template <int N, int Last, std::size_t K, int Degree, Damping Kind>
HWY_INLINE void value_and_slope(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec z, Vec& value,
                                Vec& slope) {
    slope = MulAdd(slope, z, value);
    value = MulAdd(value, z, e.x[N][k]);
    if constexpr (N > Last) {
        value_and_slope<N - 1, Last>(e, k, z, value, slope);
    }
}

/// Displacement and velocity at z become the present ones.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void move(Expansion<K, Degree, Kind>& e, double z) {
    constexpr int split = 5;
    const Vec zz = splat(z);
    const Vec per_unit = splat(e.piece.per_unit);
    const double half = z * z * z * z;
    const Vec power = splat(half * z);
    const Vec power_slope = splat(split * half);
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        // two halves, so that they can be worked on side by side
        Vec low = e.x[split - 1][k];
        Vec low_slope = zero();
        value_and_slope<split - 2, 0>(e, k, zz, low, low_slope);
        Vec high = e.x[Degree][k];
        Vec high_slope = zero();
        value_and_slope<Degree - 1, split>(e, k, zz, high, high_slope);
        e.x_now.set(k, MulAdd(power, high, low));
        const Vec slope = MulAdd(power_slope, high, low_slope);
        e.v_now.set(k, per_unit * MulAdd(power, high_slope, slope));
    }
}

template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE void save_term(const Expansion<K, Degree, Kind>& e) {
    HERTZLINE_EACH_ROW(k, K) store_row(e.x[N][k], e.piece.displacement(N) + k * lanes());
}
template <std::size_t K, int Degree, Damping Kind, int... N>
HWY_INLINE void save_terms(const Expansion<K, Degree, Kind>& e, std::integer_sequence<int, N...>) {
    (save_term<N>(e), ...);
}

/// The largest overlap so far, which may lie within the piece. A parabola through the overlaps at both ends, and the slope at the first,
/// has its vertex nearby; a step of Newton's method from there finds it. A vertex far below the largest overlap before is passed over.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec largest_overlap(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec length, Vec before) {
    const Vec begin = e.d[0][k];
    const Vec end = value_at(e.d, k, length);
    const Vec largest = Max(before, end);
    const Vec rise = e.d[1][k] * length;
    const Vec bend = begin + rise - end;
    const Vec vertex = rise / (bend + bend);  // a part of the piece
    const Flags within = And(Gt(rise, zero()), Lt(rise, bend + bend));
    const Flags concerned = And(within, Gt(MulAdd(splat(0.5) * rise, vertex, begin), splat(0.9) * largest));
    if (HWY_LIKELY(AllFalse(Doubles(), concerned))) {
        return largest;
    }
    const Vec z = vertex * length;
    const Vec slope = slope_at(e.d, k, z) * length;
    const Vec found = MulAdd(slope, slope / (splat(4.0) * bend), value_at(e.d, k, z));
    return Max(largest, IfThenElse(concerned, found, largest));
}

/// Motion, contacts and series go to the chain and the piece.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void save(const Expansion<K, Degree, Kind>& e, double length) {
    const Vec z = splat(length);
    e.rows.store(ChainField::x, e.x_now);
    e.rows.store(ChainField::v, e.v_now);
    const Col<K> closed_before = e.rows.load(ChainField::closed);
    std::size_t switched = 0;
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        switched += CountTrue(Doubles(), Ne(e.closed[k], closed_before[k]));
    }
    e.rows.chain().contact_events += static_cast<std::int64_t>(switched);
    e.rows.store(ChainField::closed, e.closed);
    e.rows.store(ChainField::overlap, e.overlaps);
    Col<K> peak = e.rows.load(ChainField::peak_overlap);
    HERTZLINE_EACH_ROW(k, e.rows.count()) peak.set(k, largest_overlap(e, k, z, peak[k]));
    e.rows.store(ChainField::peak_overlap, peak);
    if constexpr (K > 0) {
        save_terms(e, std::make_integer_sequence<int, Degree + 1>());
    }
}

/// The plate to the end of the piece, and the last body with it.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void take_plate(Expansion<K, Degree, Kind>& e, double length, bool onset) {
    PlateMotion& plate = *e.piece.plate;
    finish_series<Degree>(plate, e.piece.unit_s);
    move_plate<Degree>(plate, length);
    plate.onset_forces = onset ? e.piece.onset_forces() : std::span<const OnsetForce>();
    add_onset_to_plate<Degree>(plate, length);
    follow_plate(e, length);
    if (e.piece.keeps_ledger) {
        account_plate<Quadrature<Degree>>(plate, last_contact(e, std::make_index_sequence<Degree + 1>()),
                                          e.rows.chain().damping_law, length, e.piece.unit_s);
    }
}

/// Rare cases work on a copy: nothing that has its address taken stays in registers.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void take(Expansion<K, Degree, Kind>& e) {
    using Copy = Expansion<K, Degree, Kind>;
    SeriesPiece& piece = e.piece;
    if (!piece.waves.silent && !piece.waves.expanded) {
        expand_horn(piece);
    }
    if (HWY_UNLIKELY(piece.plate != nullptr)) {
        begin_plate<Degree>(*piece.plate);
    }
    const bool onset = begin(e);
    if (HWY_UNLIKELY(e.held)) {
        orders<true>(e, std::make_integer_sequence<int, Degree - 1>());
    } else {
        orders<false>(e, std::make_integer_sequence<int, Degree - 1>());
    }
    double length = trusted_length(e, onset);
    move(e, length);
    if (HWY_UNLIKELY(e.clamped)) {
        length = until_a_switch(Copy(e), length);
        move(e, length);
    }
    if (HWY_UNLIKELY(any_switch(e, length))) {
        length = e.clamped ? first_clamped_switch(Copy(e), length)
                           : first_crossing(Overlaps<K, Degree>(e), piece.negligible, length);
        move(e, length);
    }
    if (HWY_UNLIKELY(onset)) {
        Copy copy(e);
        add_onset_force(copy, length);
        e.x_now = copy.x_now;
        e.v_now = copy.v_now;
    }
    if (HWY_UNLIKELY(piece.plate != nullptr)) {
        take_plate(e, length, onset);
    }
    if (piece.keeps_ledger) {
        account(e, length);
    }
    if (!piece.waves.silent && piece.waves.turns) {
        turn_horn(piece.waves, length);
    }
    piece.length = length;
    save(e, length);
}

template <std::size_t K, int Degree, Damping Kind>
void take_piece(SimdChain& chain, SeriesPiece& piece) {
    Expansion<K, Degree, Kind> expansion(chain, piece);
    take(expansion);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
