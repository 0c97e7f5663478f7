// Damping forces D delta^q delta' with q > 0 (core/model/contact_law.hpp) as series. Included once per SIMD target.
//
// Such a force is the slope of W = D delta^p/p, p = q + 1, whose series follows from that of the overlap as the elastic force's does.
// It vanishes where a contact opens or closes, less smoothly than the elastic force.
#if defined(HERTZLINE_DAMPING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_DAMPING_INL
#undef HERTZLINE_DAMPING_INL
#else
#define HERTZLINE_DAMPING_INL
#endif

#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// The factor of delta' in the force of a contact that overlaps so far [kg/s]. @param damping D
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec damping_at(const Expansion<K, Degree, Kind>& e, Vec damping, Vec overlap) {
    if constexpr (Kind == Damping::linear) {
        return damping;
    } else {
        return damping * damping_power(e.rows.chain().damping_law, pressed(overlap));
    }
}

/// Damping force of contact k at z [N]. @param slope of the overlap [m]
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec damping_force(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec z, Vec slope) {
    if constexpr (Kind == Damping::linear) {
        return e.decay[k] * splat(1 / e.square) * slope;
    } else {
        const Vec damping = e.closed[k] * e.rows.load(ChainField::damping)[k];
        return damping_at(e, damping, value_at(e.d, k, z)) * splat(e.piece.per_unit) * slope;
    }
}

/// Adds the product of W's order J and the overlap's order N - J to the sum for W's order N.
template <int N, int J, std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec damping_products(const Expansion<K, Degree, Kind>& e, std::size_t k) {
    if constexpr (J == N) {
        return zero();
    } else {
        const double power = damping_exponent(e.rows.chain().damping_law) + 1;
        const Vec weight = splat((power * (N - J) - J) / N);
        return MulAdd(weight * e.w[J][k], e.d[N - J][k], damping_products<N, J + 1>(e, k));
    }
}

/// Order N of W, from which order N - 1 of the force follows. @returns it without the term of the overlap's order N
template <int N, std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec expand_damping(Expansion<K, Degree, Kind>& e, std::size_t k) {
    const Vec bent = damping_products<N, 1>(e, k) * e.per_overlap[k];
    e.w[N].set(k, MulAdd(e.decay[k], e.d[N][k], bent));
    return bent;
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
