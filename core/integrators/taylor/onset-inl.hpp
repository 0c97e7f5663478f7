// Contacts that have just closed: their elastic force k (w t)^(3/2) (1 + ...) has no series in whole powers. Included once per SIMD target.
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
#include "core/integrators/taylor/expansion-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// (a/b)^(numerator/denominator) within 6 %, from the bits of the exponents: enough for the length of a piece.
HWY_INLINE double rough_power(double a, double b, std::int64_t numerator, std::int64_t denominator) {
    const std::int64_t exponent = std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b);
    return std::bit_cast<double>(exponent / denominator * numerator + std::bit_cast<std::int64_t>(1.0));
}

/// A length during which contacts that have just closed overlap by no more than what counts.
template <std::size_t K, int Degree>
HWY_NOINLINE double negligible_length(const Expansion<K, Degree>& e) {
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

/// The onset force is added without the chain's answer to it: the piece is short enough for that answer to
/// stay below the tolerance, and for the overlap to grow steadily. Or no longer than it does not count at all.
template <std::size_t K, int Degree>
HWY_INLINE double onset_length(Expansion<K, Degree>& e) {
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
    const double length = std::min(rough_power(e.piece.tolerance, answer, 2, 7), steady);
    if (largest_lane(fastest) > 1e3 * e.piece.negligible) {
        return length;
    }
    const double without = negligible_length(Expansion<K, Degree>(e));
    if (without > length) {
        HERTZLINE_EACH_ROW(k, e.rows.count()) e.onset.set(k, zero());
    }
    return std::max(length, without);
}

/// Elastic forces of contacts that have just closed, times unit^2: coefficients of z^(n + 3/2) in
/// k (z g)^(3/2) with g = delta/z, by the power rule.
template <std::size_t K, int Degree>
HWY_INLINE std::array<Col<K>, onset_terms> onset_force(const Expansion<K, Degree>& e) {
    using Scratch = typename Expansion<K, Degree>::Scratch;
    std::array q{e.rows.scratch(Scratch::onset_term_0), e.rows.scratch(Scratch::onset_term_1),
                 e.rows.scratch(Scratch::onset_term_2), e.rows.scratch(Scratch::onset_term_3),
                 e.rows.scratch(Scratch::onset_term_4)};
    HERTZLINE_EACH_ROW(k, e.rows.count()) {
        const Vec w = IfThenElse(Gt(e.onset[k], zero()), e.d[1][k], splat(1.0));
        q[0].set(k, hertz(e.onset[k] * e.stiffness[k] * splat(e.square), w));
        for (int n = 1; n < onset_terms; ++n) {
            Vec sum = zero();
            for (int j = 0; j < n; ++j) {
                const Vec weight = splat((1.5 * (n - j) - j) / n);
                sum = MulAdd(weight * q[j][k], e.d[n - j + 1][k], sum);
            }
            q[n].set(k, sum / w);
        }
    }
    return q;
}

/// Adds what they do to velocities and displacements by z: the onset force integrated once and twice.
template <std::size_t K, int Degree>
HWY_NOINLINE void add_onset_force(Expansion<K, Degree>& e, double z) {
    const std::array<Col<K>, onset_terms> q = onset_force(e);
    double power = z * std::sqrt(z);  // z^(n + 3/2)
    for (int n = 0; n < onset_terms; ++n, power *= z) {
        const Vec for_v = splat(z * power / ((n + 2.5) * e.piece.unit_s));
        const Vec for_x = splat(z * z * power / ((n + 2.5) * (n + 3.5)));
        HERTZLINE_EACH_ROW(k, e.rows.count()) {
            const Vec net = e.inv_mass[k] * (q[n][k] - e.rows.right(q[n], k));
            e.v_now.set(k, MulAdd(for_v, net, e.v_now[k]));
            e.x_now.set(k, MulAdd(for_x, net, e.x_now[k]));
            store_row(net, e.piece.onset_force(n) + k * lanes());
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
