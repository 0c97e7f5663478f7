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
#include <utility>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"
#include "core/integrators/taylor/modes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

constexpr double factorial(int n) {
    return n < 2 ? 1 : n * factorial(n - 1);
}

/// 1/k!
inline constexpr auto per_factorial = [] {
    std::array<double, PlateMotion::most_state_terms + 4> all{1};
    for (std::size_t k = 1; k < all.size(); ++k) {
        all[k] = all[k - 1] / static_cast<double>(k);
    }
    return all;
}();

/// Adds the effect of one part of one state on the derivatives of all orders.
template <std::size_t... K>
HWY_INLINE void add_state(double state, const double* row, std::size_t stride,
                          std::array<ModeVec, sizeof...(K)>& sums, std::index_sequence<K...> /*orders*/) {
    const ModeVec s = hn::Set(ModeTag(), state);
    ((sums[K] = MulAdd(s, hn::Load(ModeTag(), row + K * stride), sums[K])), ...);
}

/// Derivatives of the modes' velocities, and the reaction to the body, as they are without the force of this piece.
template <int Degree>
HWY_INLINE void begin_plate(PlateMotion& plate) {
    plate.behind.fill(0);
    each_vector_of_modes(plate, [&](std::size_t first) HWY_ATTR {
        constexpr auto orders = std::make_index_sequence<Degree>();
        std::array<ModeVec, Degree> sums;
        sums.fill(hn::Zero(ModeTag()));
        for (std::size_t j = 0; j < plate.pairs(); ++j) {
            add_state(plate.state().re[j], plate.of_state(j, 0) + first, plate.stride(), sums, orders);
            add_state(plate.state().im[j], plate.of_state(j, 1) + first, plate.stride(), sums, orders);
        }
        for (std::size_t k = 0; k < Degree; ++k) {
            hn::Store(sums[k], ModeTag(), plate.mode_terms() + k * plate.stride() + first);
            if (k > 0) {
                plate.behind[k - 1] += plate.reaction() * sum_of_modes(sums[k]);
            }
        }
    });
}

/// Stores order N of the last contact's force, and puts the plate's force on the last body into the pad's slot.
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE void exchange_with_plate(Expansion<K, Degree, Kind>& e, Col<K>& force) {
    PlateMotion& plate = *e.piece.plate;
    double behind = plate.behind[N];
    for (std::size_t m = 0; m < N; ++m) {
        behind += plate.answer[N - 1 - m] * plate.force[m];
    }
    behind /= factorial(N + 2);
    double handed = 0;
    if constexpr (K == 0) {
        handed = force.rows[plate.end_slot];
        force.rows[plate.pad_slot] += behind;
    } else {
        HERTZLINE_EACH_ROW(k, K) store_row(force[k], plate.room(0) + k * lanes());
        handed = plate.room(0)[plate.end_slot];
        HERTZLINE_EACH_ROW(k, K) {
            force.set(k, MulAdd(splat(behind), load_row(plate.pad_flag() + k * lanes()), force[k]));
        }
    }
    plate.force[N] = factorial(N + 2) * handed;
}

/// The polynomials of the modes' velocities, once all orders of the force are known.
/// @returns their largest last term, as those of the displacements are looked at [m]
template <int Degree>
HWY_INLINE double finish_modes(PlateMotion& plate, double unit_s) {
    double largest = 0;
    each_vector_of_modes(plate, [&](std::size_t first) HWY_ATTR {
        double* const terms = plate.mode_terms() + first;
        const double* const of_force = plate.of_force() + first;
        const std::size_t stride = plate.stride();
        ModeVec last = hn::Zero(ModeTag());
        double share = 1;
        for (std::size_t k = 0; k < Degree; ++k) {
            ModeVec sum = hn::Load(ModeTag(), terms + k * stride);
            for (std::size_t m = 0; m < k; ++m) {
                const ModeVec answer = hn::Load(ModeTag(), of_force + (k - 1 - m) * stride);
                sum = MulAdd(hn::Set(ModeTag(), plate.force[m]), answer, sum);
            }
            sum = sum * hn::Set(ModeTag(), share);
            hn::Store(sum, ModeTag(), terms + k * stride);
            share /= static_cast<double>(k + 1);
            if (k >= Degree - 2) {
                const double factor = k == Degree - 1 ? unit_s / Degree : 0.5 * unit_s / (Degree - 1);
                last = Max(last, hn::Set(ModeTag(), factor) * Abs(sum));
            }
        }
        largest = std::max(largest, GetLane(hn::MaxOfLanes(ModeTag(), last)));
    });
    plate.moves = true;
    return largest;
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

/// The states at z, as exactly as the force's polynomial has them: exp(w) y + sum_m F^(m) z^(m + 1) phi_(m + 1)(w), where w is a rate
/// times z (M. Hochbruck and A. Ostermann, Acta Numerica 19 (2010) 209, section 2.1). Rates may be much faster than the motion that the
/// series follow: no step is too long for them.
template <int Degree>
HWY_INLINE void move_plate(const PlateMotion& plate, double z) {
    constexpr int first = Degree - 1;
    const PlateMotion::Pairs state = plate.state();
    const PlateMotion::Pairs rate = plate.rate();
    std::array<double, Degree> pushes{};  // F^(m) z^(m + 1)
    double power = z;
    for (std::size_t m = 0; m < first; ++m, power *= z) {
        pushes[m] = plate.force[m] * power;
    }
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        const Complexes w{splat(z) * load_row(rate.re + j), splat(z) * load_row(rate.im + j)};
        Complexes phi_k = phi<first>(w, plate.terms_until(z, j) - first);
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

/// Adds the effect of an onset force to the modes' velocities.
template <int Degree>
HWY_INLINE void find_onset_terms(const PlateMotion& plate, std::size_t number, double exponent,
                                 const std::array<double, onset_terms>& force) {
    each_vector_of_modes(plate, [&](std::size_t first) HWY_ATTR {
        double* const terms = plate.onset_terms(number) + first;
        for (int n = 0; n < Degree; ++n) {
            ModeVec sum = hn::Zero(ModeTag());
            for (int i = 0; i <= std::min(n, onset_terms - 1); ++i) {
                double share = force[i];
                for (int k = i; k <= n; ++k) {
                    share /= k + exponent + 1;
                }
                const auto row = static_cast<std::size_t>(n - i);
                const ModeVec answer = hn::Load(ModeTag(), plate.of_force() + row * plate.stride() + first);
                sum = MulAdd(hn::Set(ModeTag(), share), answer, sum);
            }
            hn::Store(sum, ModeTag(), terms + static_cast<std::size_t>(n) * plate.stride());
        }
    });
}

/// The onset forces of the last contact act on the plate.
template <int Degree>
HWY_NOINLINE void add_onset_to_plate(const PlateMotion& plate, double z) {
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
HWY_INLINE void follow_plate(Expansion<K, Degree, Kind>& e) {
    const PlateMotion& plate = *e.piece.plate;
    const double x = row_times_states(plate, plate.displacement());
    const double v = row_times_states(plate, plate.velocity());
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

/// The polynomials of the velocities under the contact and of the face.
template <int Degree>
HWY_INLINE void find_velocities(PlateMotion& plate) {
    plate.centre = {};
    plate.face = {};
    each_vector_of_modes(plate, [&](std::size_t first) HWY_ATTR {
        const ModeVec means = hn::Load(ModeTag(), plate.mean_shapes() + first);
        for (std::size_t k = 0; k < Degree; ++k) {
            const ModeVec term = hn::Load(ModeTag(), plate.mode_terms() + k * plate.stride() + first);
            plate.centre.terms[k] += sum_of_modes(term);
            plate.face.terms[k] += sum_of_modes(means * term);
            for (std::size_t i = 0; i < plate.onset_forces.size(); ++i) {
                const ModeVec added = hn::Load(ModeTag(), plate.onset_terms(i) + k * plate.stride() + first);
                plate.centre.onset_terms[i][k] += sum_of_modes(added);
                plate.face.onset_terms[i][k] += sum_of_modes(means * added);
            }
        }
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
