// A modal plate behind the last contact, order by order (plate_motion.hpp). Included once per SIMD target.
#if defined(HERTZLINE_PLATE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_PLATE_INL
#undef HERTZLINE_PLATE_INL
#else
#define HERTZLINE_PLATE_INL
#endif

#include <algorithm>
#include <array>
#include <cmath>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

constexpr double factorial(int n) {
    return n < 2 ? 1 : n * factorial(n - 1);
}

/// 1/k!
inline constexpr auto per_factorial = [] {
    std::array<double, most_series_terms + PlateMotion::most_terms_between + 4> all{1};
    for (std::size_t k = 1; k < all.size(); ++k) {
        all[k] = all[k - 1] / static_cast<double>(k);
    }
    return all;
}();

/// 1/n, and 0 for n = 0
inline constexpr auto per_whole = [] {
    std::array<double, most_series_terms> all{};
    for (std::size_t n = 1; n < all.size(); ++n) {
        all[n] = 1 / static_cast<double>(n);
    }
    return all;
}();

/// What the states do, from their rows. @param row_width numbers in a row @param count of them that are wanted
HWY_INLINE void rows_times_states(const PlateMotion& plate, const double* rows, std::size_t row_width,
                                  std::size_t count, double* out) {
    const PlateMotion::Pairs state = plate.state();
    for (std::size_t c = 0; c < count; c += lanes()) {
        Vec of_re = zero();
        Vec of_im = zero();
        for (std::size_t j = 0; j < plate.pairs(); ++j) {
            const double* const row = rows + 2 * j * row_width + c;
            of_re = MulAdd(splat(state.re[j]), load_row(row), of_re);
            of_im = MulAdd(splat(state.im[j]), load_row(row + row_width), of_im);
        }
        store_row(of_re + of_im, out + c);
    }
}

/// The states' reaction to the body as it is without the force of this piece.
template <int Degree>
HWY_INLINE void begin_plate(PlateMotion& plate) {
    rows_times_states(plate, plate.reaction_rows(), PlateMotion::width, Degree - 1, plate.behind.data());
    if (HWY_UNLIKELY(plate.is_carried)) {
        for (std::size_t k = 0; k + 1 < Degree; ++k) {
            plate.behind[k] -= plate.carried[k + 2] / plate.mobility();
        }
    }
    if (plate.shows_face) {
        rows_times_states(plate, plate.face_rows(), PlateMotion::width, Degree, plate.face.terms.data());
    }
}

/// A column's value in the slot of the last body, in all lanes.
template <std::size_t K>
HWY_INLINE Vec in_end_slot(const PlateMotion& plate, const Col<K>& column) {
    if constexpr (K == 0) {
        return splat(column.rows[plate.end_slot]);
    } else {
        Vec row = column[0];
        HERTZLINE_EACH_ROW(k, K) {
            if (k == plate.end_row) {
                row = column[k];
            }
        }
        return hn::TableLookupLanes(row, hn::SetTableIndices(Doubles(), plate.end_lane.data()));
    }
}

/// Stores order N of the last contact's force, and puts the plate's force on the last body into the pad's slot. Each order waits for the
/// one before: the answer to that is added last, its effect on the orders to come beside the way.
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE void exchange_with_plate(Expansion<K, Degree, Kind>& e, Col<K>& force) {
    PlateMotion& plate = *e.piece.plate;
    Vec behind = splat(plate.behind[N]);
    if constexpr (N > 0) {
        const double* const answer = plate.reaction_to(N - 1);
        behind = MulAdd(splat(answer[N]), e.handed, behind);
        for (std::size_t n = N / lanes() * lanes(); n + 1 < Degree; n += lanes()) {
            double* const later = plate.behind.data() + n;
            store_row(MulAdd(load_row(answer + n), e.handed, load_row(later)), later);
        }
    }
    e.handed = in_end_slot(plate, force);
    if constexpr (K == 0) {
        force.rows[plate.pad_slot] += GetLane(behind);
    } else {
        HERTZLINE_EACH_ROW(k, K) {
            force.set(k, MulAdd(behind, load_row(plate.pad_flag() + k * lanes()), force[k]));
        }
    }
    plate.force[N] = factorial(N + 2) * GetLane(e.handed);
}

/// A complex number in each lane.
struct Complexes {
    Vec re, im;
};
/// a b + c
HWY_INLINE Complexes product_plus(const Complexes& a, const Complexes& b, double c) {
    return {NegMulAdd(a.im, b.im, MulAdd(a.re, b.re, splat(c))), MulAdd(a.re, b.im, a.im * b.re)};
}

/// sum_j w^j/(j + K)!, by its even and odd terms side by side. @param terms of both
template <int K>
HWY_INLINE Complexes phi(const Complexes& w, int terms) {
    const Complexes square = product_plus(w, w, 0);
    Complexes even{zero(), zero()};
    Complexes odd{zero(), zero()};
    for (int j = (terms + 1) / 2 * 2; j >= 0; j -= 2) {
        even = product_plus(even, square, per_factorial[K + j]);
        odd = product_plus(odd, square, per_factorial[K + j + 1]);
    }
    const Complexes rest = product_plus(odd, w, 0);
    return {even.re + rest.re, even.im + rest.im};
}

/// The states after a step to a place of the grid: what they have become, and the answers to the force's derivatives.
template <int Degree>
HWY_INLINE void step_plate(const PlateMotion& plate, int place) {
    const PlateMotion::Pairs state = plate.state();
    const PlateMotion::Pairs turn = plate.turn(place);
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        const Complexes before{load_row(state.re + j), load_row(state.im + j)};
        Complexes sum = product_plus(before, {load_row(turn.re + j), load_row(turn.im + j)}, 0);
        for (std::size_t m = 0; m + 1 < Degree; ++m) {
            const PlateMotion::Pairs answer = plate.answer(place, m);
            const Vec force = splat(plate.force[m]);
            sum = {MulAdd(force, load_row(answer.re + j), sum.re),
                   MulAdd(force, load_row(answer.im + j), sum.im)};
        }
        store_row(sum.re, state.re + j);
        store_row(sum.im, state.im + j);
    }
}

/// The states z later, between two places of the grid: exp(w) y + sum_m F^(m) z^(m + 1) phi_(m + 1)(w), where w is a rate times z
/// (M. Hochbruck and A. Ostermann, Acta Numerica 19 (2010) 209, section 2.1). @param force its derivatives at the start
template <int Degree>
HWY_NOINLINE void drift_plate(const PlateMotion& plate, const std::array<double, Degree - 1>& force,
                              double z) {
    constexpr int first = Degree - 1;
    const PlateMotion::Pairs state = plate.state();
    const PlateMotion::Pairs rate = plate.rate();
    std::array<double, Degree> pushes{};  // F^(m) z^(m + 1)
    double power = z;
    for (std::size_t m = 0; m < first; ++m, power *= z) {
        pushes[m] = force[m] * power;
    }
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        const Complexes w{splat(z) * load_row(rate.re + j), splat(z) * load_row(rate.im + j)};
        Complexes phi_k = phi<first>(w, std::max(0, plate.terms_between() - first));
        Vec re = splat(pushes[first - 1]) * phi_k.re;
        Vec im = splat(pushes[first - 1]) * phi_k.im;
        for (std::size_t k = first - 1; k > 0; --k) {
            phi_k = product_plus(w, phi_k, per_factorial[k]);
            re = MulAdd(splat(pushes[k - 1]), phi_k.re, re);
            im = MulAdd(splat(pushes[k - 1]), phi_k.im, im);
        }
        const Complexes turn = product_plus(w, phi_k, 1);
        const Vec y_re = load_row(state.re + j);
        const Vec y_im = load_row(state.im + j);
        store_row(NegMulAdd(turn.im, y_im, MulAdd(turn.re, y_re, re)), state.re + j);
        store_row(MulAdd(turn.im, y_re, MulAdd(turn.re, y_im, im)), state.im + j);
    }
}

/// The first derivatives of the force at z.
template <int Degree, std::size_t Count>
HWY_INLINE std::array<double, Count> force_at(const PlateMotion& plate, double z) {
    std::array<double, Count> at{};
    for (std::size_t k = 0; k < Count; ++k) {
        for (std::size_t m = Degree - 2; m > k; --m) {
            at[k] = (at[k] + plate.force[m]) * (z * per_whole[m - k]);
        }
        at[k] += plate.force[k];
    }
    return at;
}

/// The states at z, as exactly as the force's polynomial has them. Rates may be much faster than the motion that the series follow: no
/// step is too long for them.
template <int Degree>
HWY_INLINE void move_plate(const PlateMotion& plate, double z) {
    const int place = static_cast<int>(z * PlateMotion::grid);
    const double there = static_cast<double>(place) / PlateMotion::grid;
    if (place > 0) {
        step_plate<Degree>(plate, place);
    }
    if (z > there) {
        drift_plate<Degree>(plate, force_at<Degree, Degree - 1>(plate, there), z - there);
    }
}

/// Adds the effect of an onset force of the last contact on the states: f_n z^(n + exponent), integrated over and over with their rates.
template <int Degree>
HWY_INLINE void add_onset_to_states(const PlateMotion& plate, const OnsetForce& onset,
                                    const std::array<double, onset_terms>& force, double z) {
    const PlateMotion::Pairs state = plate.state();
    const PlateMotion::Pairs rate = plate.rate();
    const double start = onset.integrated_power(z);
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        const Vec rate_re = splat(z) * load_row(rate.re + j);
        const Vec rate_im = splat(z) * load_row(rate.im + j);
        Vec re = zero();
        Vec im = zero();
        Vec sum_re = load_row(state.re + j);
        Vec sum_im = load_row(state.im + j);
        double power = start;
        for (int n = 0; n < Degree; ++n, power *= z) {
            const Vec share = splat(1 / (n + onset.exponent + 1));
            const Vec input = splat(n < onset_terms ? force[n] * power : 0.0);
            const Vec before = re;
            re = share * NegMulAdd(rate_im, im, MulAdd(rate_re, before, input));
            im = share * MulAdd(rate_im, before, rate_re * im);
            sum_re = sum_re + re;
            sum_im = sum_im + im;
        }
        store_row(sum_re, state.re + j);
        store_row(sum_im, state.im + j);
    }
}

/// Adds the effect of an onset force to the velocity of the face.
template <int Degree>
HWY_INLINE void find_onset_terms(PlateMotion& plate, std::size_t number, double exponent,
                                 const std::array<double, onset_terms>& force) {
    for (int n = 0; n < Degree; ++n) {
        double sum = 0;
        for (int i = 0; i <= std::min(n, onset_terms - 1); ++i) {
            double share = force[i];
            for (int k = i; k <= n; ++k) {
                share /= k + exponent + 1;
            }
            sum += share * plate.face_answer[n - i];
        }
        plate.face.onset_terms[number][n] = sum;
    }
}

/// The onset forces of the last contact act on the plate.
template <int Degree>
HWY_NOINLINE void add_onset_to_plate(PlateMotion& plate, double z) {
    for (std::size_t number = 0; number < plate.onset_forces.size(); ++number) {
        const OnsetForce& onset = plate.onset_forces[number];
        std::array<double, onset_terms> force{};
        for (int n = 0; n < onset_terms; ++n) {
            force[n] = onset.term(n, plate.end_slot) / plate.mobility();
        }
        add_onset_to_states<Degree>(plate, onset, force, z);
        find_onset_terms<Degree>(plate, number, onset.exponent, force);
    }
}

/// Sum over all pairs of a row times the states.
HWY_INLINE double row_times_states(const PlateMotion& plate, const PlateMotion::Pairs& row) {
    const PlateMotion::Pairs states = plate.state();
    Vec re = zero();
    Vec im = zero();
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        re = MulAdd(load_row(row.re + j), load_row(states.re + j), re);
        im = MulAdd(load_row(row.im + j), load_row(states.im + j), im);
    }
    return GetLane(hn::SumOfLanes(Doubles(), re + im));
}

/// The last body goes where the states say.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void follow_plate(Expansion<K, Degree, Kind>& e, double length) {
    const PlateMotion& plate = *e.piece.plate;
    double x = row_times_states(plate, plate.displacement());
    double v = row_times_states(plate, plate.velocity());
    if (HWY_UNLIKELY(plate.is_carried)) {
        double moved = 0;
        double slope = 0;
        for (std::size_t n = plate.carried.size(); n-- > 0;) {
            slope = slope * length + moved;
            moved = moved * length + plate.carried[n];
        }
        x += moved;
        v += slope * e.piece.per_unit;
    }
    if constexpr (K == 0) {
        e.x_now.rows[plate.end_slot] = x;
        e.v_now.rows[plate.end_slot] = v;
    } else {
        HERTZLINE_EACH_ROW(k, K) {
            const Flags end = Gt(load_row(plate.end_flag() + k * lanes()), zero());
            e.x_now.set(k, IfThenElse(end, splat(x), e.x_now[k]));
            e.v_now.set(k, IfThenElse(end, splat(v), e.v_now[k]));
        }
    }
}

/// The polynomials of the force and of the face's velocity, once all orders of the force are known.
template <int Degree>
HWY_INLINE void finish_series(PlateMotion& plate, double unit_s) {
    const double per_square = 1 / (unit_s * unit_s);
    for (std::size_t m = 0; m + 1 < Degree; ++m) {
        plate.force_terms[m] = per_square * per_factorial[m] * plate.force[m];
    }
    if (plate.shows_face) {
        for (std::size_t k = Degree; k-- > 0;) {
            double sum = plate.face.terms[k];
            for (std::size_t m = 0; m < k; ++m) {
                sum += plate.force[m] * plate.face_answer[k - 1 - m];
            }
            plate.face.terms[k] = per_factorial[k] * sum;
        }
    }
    plate.moves = true;
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
