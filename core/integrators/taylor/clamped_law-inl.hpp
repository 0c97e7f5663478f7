// The law without tension: a contact lets go as soon as dashpot and elasticity together would pull. Included once per SIMD target.
#if defined(HERTZLINE_CLAMPED_LAW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_CLAMPED_LAW_INL
#undef HERTZLINE_CLAMPED_LAW_INL
#else
#define HERTZLINE_CLAMPED_LAW_INL
#endif

#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/taylor/damping-inl.hpp"
#include "core/integrators/taylor/expansion-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

inline constexpr double grazing = 1e-7;      ///< force over its change in a unit that counts as none
inline constexpr double cancelled = 1e-13;   ///< of a force's parts: their sum counts as none
inline constexpr double rounding = 0x1p-51;  ///< of a difference of velocities, of the larger of both

/// 1 where a contact pushes at the piece's start, by the sign of the total force.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec pushing(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec damping) {
    const Vec w = splat(e.piece.per_unit) * e.d[1][k];
    const Vec force = MulAdd(damping, w, e.u[0][k]);
    Flags pushes = And(Gt(e.overlaps[k], zero()), Gt(force, zero()));
    if constexpr (Kind == Damping::nonlinear) {
        pushes = Or(pushes, Gt(e.onset[k], zero()));  // its force begins with zero
    }
    const Flags pad = Eq(e.stiffness[k], zero());
    return one_where(Or(pad, pushes));
}

/// Where the total force is zero within rounding its slope decides.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE void settle_grazing_force(Expansion<K, Degree, Kind>& e, std::size_t k) {
    const Vec factor = damping_at(e, e.rows.load(ChainField::damping)[k], e.d[0][k]);
    const Vec damping = splat(e.piece.per_unit) * factor;
    const Vec force = MulAdd(damping, e.d[1][k], e.u[0][k]);
    const Vec elastic_slope = splat(1.5) * e.u[0][k] * (e.per_overlap[k] * e.d[1][k]);
    Vec slope = MulAdd(damping + damping, e.d[2][k], elastic_slope);
    if constexpr (Kind == Damping::nonlinear) {
        const Vec q = splat(damping_exponent(e.rows.chain().damping_law));
        slope = MulAdd(q * damping * e.per_overlap[k], e.d[1][k] * e.d[1][k], slope);
    }
    const Flags near_zero = Le(Abs(force), splat(grazing) * Abs(slope));
    const Flags undecided = And(And(near_zero, Gt(e.u[0][k], zero())), Gt(e.stiffness[k], zero()));
    const Vec decided = one_where(Gt(slope, zero()));
    e.closed.set(k, IfThenElse(undecided, decided, e.closed[k]));
    e.decay.set(k, e.closed[k] * damping * splat(e.square));
    if constexpr (Kind == Damping::nonlinear) {
        e.w[1].set(k, e.decay[k] * e.d[1][k]);
    }
}

/// Whether contact k, were it closed, would push at z. Where dashpot and elasticity cancel to rounding it is
/// its value at the piece's start: contacts that graze on and on must not end one piece after another.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Flags would_push(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec z) {
    const Vec elastic = horner<0, Degree - 2>(e.u, k, z);
    const Vec factor = damping_at(e, e.rows.load(ChainField::damping)[k], value_at(e.d, k, z));
    const Vec damping = splat(e.piece.unit_s) * factor;
    const Vec dashpot = damping * slope_at(e.d, k, z);
    const Vec parts = splat(cancelled) * (Abs(elastic) + Abs(dashpot));
    const Vec velocity = splat(rounding) * Abs(e.x[1][k]);
    const Vec rounding_error = MulAdd(damping, velocity, parts);
    const Vec of_closed = splat(1.0) - (e.closed[k] + e.closed[k]);  // -1, else 1
    return Gt(dashpot + elastic, of_closed * rounding_error);
}

/// Elastic energy that a contact which has let go loses from one overlap to another, as it relaxes [J]. A difference of energies is exact;
/// a quadrature of the force, whose power 3/2 ends in the middle of a piece, is not.
template <std::size_t K, int Degree, Damping Kind>
HWY_INLINE Vec relaxed(const Expansion<K, Degree, Kind>& e, std::size_t k, Vec from, Vec to) {
    return (splat(1.0) - e.closed[k]) *
           (elastic_energy(e.stiffness[k], from) - elastic_energy(e.stiffness[k], to));
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
