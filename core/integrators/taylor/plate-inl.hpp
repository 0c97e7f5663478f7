// A modal plate behind the last contact, order by order (plate_motion.hpp). Included once per SIMD target.
#if defined(HERTZLINE_PLATE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_PLATE_INL
#undef HERTZLINE_PLATE_INL
#else
#define HERTZLINE_PLATE_INL
#endif

#include <algorithm>
#include <cmath>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/taylor/damping-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

constexpr double factorial(int n) {
    return n < 2 ? 1 : n * factorial(n - 1);
}

/// Sum over all pairs of a row times states.
HWY_INLINE double row_times(const PlateMotion& plate, const PlateMotion::Pairs& row,
                            const PlateMotion::Pairs& states) {
    Vec re = zero();
    Vec im = zero();
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        re = MulAdd(load_row(row.re + j), load_row(states.re + j), re);
        im = MulAdd(load_row(row.im + j), load_row(states.im + j), im);
    }
    return GetLane(hn::SumOfLanes(Doubles(), re + im));
}

/// The states' next derivative: rate times this one plus that of the force. @returns their reaction to the body
HWY_INLINE double differentiate(const PlateMotion& plate, int order, double force) {
    const PlateMotion::Pairs reaction = plate.reaction();
    Vec sum_re = zero();
    Vec sum_im = zero();
    const PlateMotion::Pairs now = plate.derivative(order);
    const PlateMotion::Pairs next = plate.derivative(order + 1);
    const PlateMotion::Pairs rate = plate.rate();
    const Vec input = splat(force);
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        const Vec re = load_row(now.re + j);
        const Vec im = load_row(now.im + j);
        const Vec rate_re = load_row(rate.re + j);
        const Vec rate_im = load_row(rate.im + j);
        const Vec next_re = NegMulAdd(rate_im, im, MulAdd(rate_re, re, input));
        const Vec next_im = MulAdd(rate_im, re, rate_re * im);
        store_row(next_re, next.re + j);
        store_row(next_im, next.im + j);
        sum_re = MulAdd(load_row(reaction.re + j), next_re, sum_re);
        sum_im = MulAdd(load_row(reaction.im + j), next_im, sum_im);
    }
    return GetLane(hn::SumOfLanes(Doubles(), sum_re + sum_im));
}

/// Order N of the last contact's force goes to the plate; what the plate does to the last body comes back into the pad's slot.
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE void exchange_with_plate(Expansion<K, Degree, Kind>& e, Col<K>& force) {
    PlateMotion& plate = *e.piece.plate;
    const double behind = plate.behind / factorial(N + 2);
    double handed = 0;
    if constexpr (K == 0) {
        handed = force.rows[plate.end_slot];
        force.rows[plate.pad_slot] += behind;
    } else {
        HERTZLINE_EACH_ROW(k, K) store_row(force[k], plate.room() + k * lanes());
        handed = plate.room()[plate.end_slot];
        HERTZLINE_EACH_ROW(k, K) {
            force.set(k, MulAdd(splat(behind), load_row(plate.pad_flag() + k * lanes()), force[k]));
        }
    }
    plate.behind = differentiate(plate, N, factorial(N + 2) * handed);
}

/// The motion's derivatives begin with what the plate has now.
HWY_INLINE void begin_plate(PlateMotion& plate) {
    std::copy_n(plate.state().re, 2 * plate.size(), plate.derivative(0).re);
    plate.behind = row_times(plate, plate.reaction(), plate.derivative(0));
}

/// The last terms of what the states add to velocities, as those of the displacements are looked at [m].
template <int Degree>
HWY_INLINE double last_of_plate(const PlateMotion& plate) {
    const PlateMotion::Pairs last = plate.derivative(Degree - 1);
    const PlateMotion::Pairs before = plate.derivative(Degree - 2);
    const Vec of_last = splat(1 / factorial(Degree));
    const Vec of_before = splat(0.5 / factorial(Degree - 1));
    Vec largest = zero();
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        const Vec a = Abs(load_row(last.re + j)) + Abs(load_row(last.im + j));
        const Vec b = Abs(load_row(before.re + j)) + Abs(load_row(before.im + j));
        largest = Max(largest, load_row(plate.weight().re + j) * Max(of_last * a, of_before * b));
    }
    return largest_lane(largest);
}

/// The states at z.
template <int Degree>
HWY_INLINE void move_plate(const PlateMotion& plate, double z) {
    const PlateMotion::Pairs state = plate.state();
    for (std::size_t j = 0; j < plate.size(); j += lanes()) {
        Vec re = load_row(plate.derivative(Degree - 1).re + j);
        Vec im = load_row(plate.derivative(Degree - 1).im + j);
        for (int n = Degree - 1; n > 0; --n) {
            const Vec step = splat(z / n);
            re = MulAdd(step, re, load_row(plate.derivative(n - 1).re + j));
            im = MulAdd(step, im, load_row(plate.derivative(n - 1).im + j));
        }
        store_row(re, state.re + j);
        store_row(im, state.im + j);
    }
}

/// Adds what the onset forces of the last contact do to the states: they are integrated, and so is the states' answer, once.
HWY_INLINE void add_onset_to_plate(const PlateMotion& plate, const SeriesPiece& piece, double mobility,
                                   double z) {
    const PlateMotion::Pairs state = plate.state();
    const PlateMotion::Pairs rate = plate.rate();
    for (const OnsetForce& force : piece.onset_forces()) {
        double power = force.integrated_power(z);
        for (int n = 0; n < onset_terms; ++n, power *= z) {
            const double once = force.term(n, plate.end_slot) / mobility * power / (n + (force.exponent + 1));
            const Vec direct = splat(once);
            const Vec answer = splat(once * z / (n + (force.exponent + 2)));
            for (std::size_t j = 0; j < plate.size(); j += lanes()) {
                const Vec re = load_row(state.re + j) + MulAdd(answer, load_row(rate.re + j), direct);
                store_row(re, state.re + j);
                store_row(MulAdd(answer, load_row(rate.im + j), load_row(state.im + j)), state.im + j);
            }
        }
    }
}

/// The last body goes where the states say.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void follow_plate(Expansion<K, Degree, Kind>& e) {
    const PlateMotion& plate = *e.piece.plate;
    const double x = row_times(plate, plate.displacement(), plate.state());
    const double v = row_times(plate, plate.velocity(), plate.state());
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

/// Work of the last contact on the plate between the nodes' moments. @param force that of the static state is taken off [N]
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE double work_on_plate(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec z, Vec end) {
    const Vec damping = damping_force(e, k, z, slope_at(e.d, k, z));
    const Vec elastic = e.closed[k] * elastic_force(e.stiffness[k], value_at(e.d, k, z));
    const Vec work = (elastic + damping - e.static_force[k]) * slope_at(e.x, k, z);
    return GetLane(hn::SumOfLanes(Doubles(), IfThenElseZero(Gt(end, zero()), work)));
}

/// Calls visit(first) for each vector of modes.
template <class Visit>
HWY_INLINE void each_vector_of_modes(std::size_t modes, Visit&& visit) {
    for (std::size_t n = 0; n < modes; n += lanes()) {
        visit(n);
    }
}

/// The modes' velocities at z.
HWY_INLINE Vec modes_at(const double* terms, int degree, std::size_t first, Vec z) {
    constexpr std::size_t stride = PlateMotion::mode_stride;
    Vec sum = zero();
    for (int k = degree; k-- > 0;) {
        sum = MulAdd(sum, z, load_row(terms + static_cast<std::size_t>(k) * stride + first));
    }
    return sum;
}

/// The polynomials of the modes' velocities.
HWY_INLINE void find_mode_terms(const PlateMotion& plate, int degree) {
    constexpr std::size_t stride = PlateMotion::mode_stride;
    each_vector_of_modes(plate.modes(), [&](std::size_t first) HWY_ATTR {
        const double* const rows = plate.mode_rows() + first;
        double factor = 1;
        for (int k = 0; k < degree; ++k) {
            const PlateMotion::Pairs states = plate.derivative(k);
            Vec re = zero();
            Vec im = zero();
            for (std::size_t j = 0; j < plate.size(); ++j) {
                re = MulAdd(splat(states.re[j]), load_row(rows + j * stride), re);
                im = MulAdd(splat(states.im[j]), load_row(rows + (plate.size() + j) * stride), im);
            }
            store_row(splat(factor) * (re + im),
                      plate.mode_terms() + static_cast<std::size_t>(k) * stride + first);
            factor /= k + 1;
        }
    });
}

/// What the plate's material takes over the piece [J].
template <class Nodes>
HWY_INLINE double losses(const PlateMotion& plate, int degree, double length) {
    double lost = 0;
    each_vector_of_modes(plate.modes(), [&](std::size_t first) HWY_ATTR {
        Vec sum = zero();
        for (std::size_t i = 0; i < Nodes::node.size(); ++i) {
            const Vec v = modes_at(plate.mode_terms(), degree, first, splat(length * Nodes::node[i]));
            sum = MulAdd(splat(length * Nodes::weight[i]) * v, v, sum);
        }
        lost += GetLane(hn::SumOfLanes(Doubles(), sum * load_row(plate.mode_losses() + first)));
    });
    return lost;
}

/// Adds the integrals over a part of an interval, with Legendre's polynomials as weights.
inline void add_moments(const PlateMotion& plate, int degree, const PlateInterval& part, double* moments) {
    constexpr std::size_t stride = PlateMotion::mode_stride;
    // Gauss and Legendre with four nodes (Abramowitz and Stegun, table 25.4)
    constexpr std::array node{0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
    constexpr std::array weight{0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
    const double length = part.to - part.from;
    each_vector_of_modes(plate.modes(), [&](std::size_t first) HWY_ATTR {
        Vec sum0 = hn::LoadU(Doubles(), moments + first);
        Vec sum1 = hn::LoadU(Doubles(), moments + stride + first);
        Vec sum2 = hn::LoadU(Doubles(), moments + 2 * stride + first);
        Vec sum3 = hn::LoadU(Doubles(), moments + 3 * stride + first);
        for (std::size_t i = 0; i < node.size(); ++i) {
            const double z = part.from + length * node[i];
            const double x = 1 - 2 * (part.line - z) / part.interval;
            const Vec v = splat(length * weight[i] * part.unit_s) *
                          modes_at(plate.mode_terms(), degree, first, splat(z));
            sum0 = sum0 + v;
            sum1 = MulAdd(splat(x), v, sum1);
            sum2 = MulAdd(splat(0.5 * (3 * x * x - 1)), v, sum2);
            sum3 = MulAdd(splat(0.5 * x * (5 * x * x - 3)), v, sum3);
        }
        hn::StoreU(sum0, Doubles(), moments + first);
        hn::StoreU(sum1, Doubles(), moments + stride + first);
        hn::StoreU(sum2, Doubles(), moments + 2 * stride + first);
        hn::StoreU(sum3, Doubles(), moments + 3 * stride + first);
    });
}

/// Sum of products of two stretches of numbers, a multiple of mode_stride long.
inline double sum_of_products(const double* a, const double* b, std::size_t count) {
    const Doubles d;
    Vec even = zero();
    Vec odd = zero();
    for (std::size_t i = 0; i < count; i += PlateMotion::mode_stride) {
        for (std::size_t k = 0; k < PlateMotion::mode_stride; k += 2 * lanes()) {
            even = MulAdd(hn::LoadU(d, a + i + k), hn::LoadU(d, b + i + k), even);
            if (k + lanes() < PlateMotion::mode_stride) {
                odd = MulAdd(hn::LoadU(d, a + i + k + lanes()), hn::LoadU(d, b + i + k + lanes()), odd);
            }
        }
    }
    return GetLane(hn::SumOfLanes(d, even + odd));
}

/// The ledger's entries for the plate over the piece.
template <class Nodes, std::size_t K, int Degree, Damping Kind>
HWY_NOINLINE void account_plate(const Expansion<K, Degree, Kind>& e, double length) {
    PlateMotion& plate = *e.piece.plate;
    const std::size_t row = plate.end_slot / lanes();
    for (std::size_t i = 0; i < Nodes::node.size(); ++i) {
        const Vec z = splat(length * Nodes::node[i]);
        double power = 0;
        if constexpr (K == 0) {
            const Vec end =
                one_where(Eq(hn::Iota(Doubles(), 0), splat(static_cast<double>(plate.end_slot % lanes()))));
            power = work_on_plate(e, row, z, end);
        } else {
            HERTZLINE_EACH_ROW(k, K)
            power += work_on_plate(e, k, z, load_row(plate.end_flag() + k * lanes()));
        }
        plate.passed += length * Nodes::weight[i] * power;
    }
    plate.lost += losses<Nodes>(plate, Degree, length);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
