// Contacts that have just closed: their elastic force k (w t)^(3/2) (1 + ...) has no series in whole powers,
// and neither have damping forces with a power of the overlap. Included once per SIMD target.
#if defined(HERTZLINE_ONSET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_ONSET_INL
#undef HERTZLINE_ONSET_INL
#else
#define HERTZLINE_ONSET_INL
#endif

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/taylor/damping-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// (a/b)^(numerator/denominator) within 6 %, from the bits of the exponents: enough for the length of a piece.
HWY_INLINE double rough_power(double a, double b, std::int64_t numerator, std::int64_t denominator) {
    const std::int64_t exponent = std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b);
    return std::bit_cast<double>(exponent / denominator * numerator + std::bit_cast<std::int64_t>(1.0));
}

/// A length during which contacts that have just closed overlap negligibly.
template <std::size_t K, int Degree, Damping Kind>
HWY_NOINLINE double negligible_length(const Expansion<K, Degree, Kind>& e) {
    double z = 1;
    for (int halvings = 0; halvings < 40; ++halvings, z /= 2) {
        Vec largest = zero();
        HERTZLINE_EACH_ROW(k, e.rows.count()) {
            Vec sum = Abs(e.d[Degree][k]);
            for (int n = Degree - 1; n > 0; --n) {
                sum = MulAdd(sum, splat(z), Abs(e.d[n][k]));
            }
            largest = Max(largest, e.onset[k] * sum);
        }
        if (z * largest_lane(largest) <= e.piece.negligible) {
            break;
        }
    }
    return z;
}

/// How far a piece may reach with the damping force of contacts that have just closed: what their impulse would change in the chain's
/// forces, and in their own, stays below the tolerance.
template <std::size_t K, int Degree>
HWY_NOINLINE double damped_onset_length(const Expansion<K, Degree, Damping::nonlinear>& e, double length) {
    const DampingLaw law = e.rows.chain().damping_law;
    const double q = damping_exponent(law);
    const Col<K> damping = e.rows.load(ChainField::damping);
    Vec rates = zero();    // of the contacts' own velocity by its damping, times unit, divided by z^q
    Vec impulse = zero();  // velocity by damping, times unit, divided by z^(q + 1) [m]
    Vec elastic = zero();  // the same by the elastic force, divided by z^(5/2)
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        const Vec w = e.onset[k] * e.d[1][k];
        const Vec rate = e.mobility[k] * damping[k] * splat(e.piece.unit_s) *
                         (e.onset[k] * damping_power(law, pressed(w)));
        rates = Max(rates, rate);
        impulse = Max(impulse, rate * w);
        elastic = Max(elastic, e.mobility[k] * hertz(e.stiffness[k] * splat(e.square), pressed(w)));
    }
    const double rate = largest_lane(rates);
    const double by_damping = largest_lane(impulse) / (q + 1);
    const double by_elastic = largest_lane(elastic) / 2.5;
    const auto answer = [&](double z) {
        const double power = law == DampingLaw::tsuji ? std::sqrt(std::sqrt(z)) : std::sqrt(z);
        const double velocity = by_damping * power * z + by_elastic * z * z * std::sqrt(z);
        return z / (q + 2) * velocity * (e.piece.response + rate * power);
    };
    while (length > shortest && answer(length) > e.piece.tolerance) {
        length *= 0.7;
    }
    return length;
}

/// The onset force is added without the chain's answer to it: the piece is short enough for that answer to
/// stay below the tolerance, and for the overlap to grow steadily. Or no longer than it does not count at all.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE double onset_length(Expansion<K, Degree, Kind>& e) {
    Vec largest = zero();
    Vec bent = zero();
    Vec fastest = zero();
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        const Vec w = e.onset[k] * e.d[1][k];
        largest = Max(largest, e.mobility[k] * e.stiffness[k] * (w * Sqrt(w)));
        const Vec per_w = e.onset[k] / Max(e.d[1][k], splat(standstill));
        const Vec second = Abs(e.d[2][k]) * per_w;
        const Vec third = Sqrt(Abs(e.d[3][k]) * per_w);
        bent = Max(bent, Max(second, third));
        fastest = Max(fastest, w);
    }
    const double answer = 0.4 * e.square * largest_lane(largest) * e.piece.response + 1e-300;
    const double steady = 0.25 / (largest_lane(bent) + 0.25);
    double length = std::min(rough_power(e.piece.tolerance, answer, 2, 7), steady);
    if constexpr (Kind == Damping::nonlinear) {
        length = damped_onset_length(Expansion<K, Degree, Kind>(e), length);
    }
    // The force of a contact that bends even within the shortest piece has no series there, and does not count.
    const bool too_bent = length < shortest;
    if (!too_bent && largest_lane(fastest) > 1e3 * e.piece.negligible) {
        return length;
    }
    const double without = negligible_length(Expansion<K, Degree, Kind>(e));
    if (too_bent || without > length) {
        HERTZLINE_EACH_ROW(k, e.rows.count()) e.onset.set(k, zero());
    }
    return std::max(length, without);
}

/// Forces of contacts that have just closed: coefficients of z^(n + power) in (z g)^power with g = delta/z, by the power rule.
/// @param first that of n = 0 where a contact has just closed, else 0
template <std::size_t K, int Degree, Damping Kind, class First>
HWY_INLINE std::array<Col<K>, onset_terms> onset_series(const Expansion<K, Degree, Kind>& e, double power,
                                                        const First& first) {
    using Scratch = typename Expansion<K, Degree, Kind>::Scratch;
    std::array q{e.rows.scratch(Scratch::onset_term_0), e.rows.scratch(Scratch::onset_term_1),
                 e.rows.scratch(Scratch::onset_term_2), e.rows.scratch(Scratch::onset_term_3),
                 e.rows.scratch(Scratch::onset_term_4)};
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        const Vec w = IfThenElse(Gt(e.onset[k], zero()), e.d[1][k], splat(1.0));
        q[0].set(k, first(k, w));
        for (int n = 1; n < onset_terms; ++n) {
            Vec sum = zero();
            for (int j = 0; j < n; ++j) {
                const Vec weight = splat((power * (n - j) - j) / n);
                sum = MulAdd(weight * q[j][k], e.d[n - j + 1][k], sum);
            }
            q[n].set(k, sum / w);
        }
    }
    return q;
}

/// Elastic forces of contacts that have just closed, times unit^2: coefficients of z^(n + 3/2).
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE std::array<Col<K>, onset_terms> onset_elastic(const Expansion<K, Degree, Kind>& e) {
    return onset_series(e, 1.5, [&](std::size_t k, Vec w) HWY_ATTR {
        return hertz(e.onset[k] * e.stiffness[k] * splat(e.square), w);
    });
}

/// Their damping forces, times unit^2: coefficients of z^(n + q). Those of W are integrals of these.
template <std::size_t K, int Degree>
HWY_INLINE std::array<Col<K>, onset_terms> onset_damping(const Expansion<K, Degree, Damping::nonlinear>& e) {
    const DampingLaw law = e.rows.chain().damping_law;
    const double power = damping_exponent(law) + 1;
    const Col<K> damping = e.rows.load(ChainField::damping);
    auto terms = onset_series(e, power, [&](std::size_t k, Vec w) HWY_ATTR {
        return e.onset[k] * damping[k] * splat(e.piece.unit_s / power) * (w * damping_power(law, w));
    });
    for (int n = 0; n < onset_terms; ++n) {
        HERTZLINE_EACH_ROW(k, e.rows.count()) terms[n].set(k, splat(n + power) * terms[n][k]);
    }
    return terms;
}

/// Adds the effect of a force on velocities and displacements at z: its terms integrated once and twice.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void add_onset_terms(Expansion<K, Degree, Kind>& e, const std::array<Col<K>, onset_terms>& q,
                                std::size_t force, double z) {
    const OnsetForce& row = e.piece.onset_forces()[force];
    double power = row.power(z);  // z^(n + exponent)
    for (int n = 0; n < onset_terms; ++n, power *= z) {
        const double once = n + (row.exponent + 1);
        const Vec for_v = splat(z * power / (once * e.piece.unit_s));
        const Vec for_x = splat(z * z * power / (once * (n + (row.exponent + 2))));
        if (e.piece.tip != nullptr) {
            e.piece.tip->onset[force][static_cast<std::size_t>(n)] =
                -e.piece.tip->inv_mass * in_first_contact(q[n]);
        }
        HERTZLINE_EACH_ROW(k, e.rows.count()) {
            const Vec net = e.inv_mass[k] * (q[n][k] - e.rows.right(q[n], k));
            e.v_now.set(k, MulAdd(for_v, net, e.v_now[k]));
            e.x_now.set(k, MulAdd(for_x, net, e.x_now[k]));
            store_row(net, e.piece.onset_force(force, n) + k * lanes());
        }
    }
}

/// Adds the effect of contacts that have just closed, until z.
template <std::size_t K, int Degree, Damping Kind>
HWY_NOINLINE void add_onset_force(Expansion<K, Degree, Kind>& e, double z) {
    add_onset_terms(e, onset_elastic(e), 0, z);
    if constexpr (Kind == Damping::nonlinear) {
        add_onset_terms(e, onset_damping(e), 1, z);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
