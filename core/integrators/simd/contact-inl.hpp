// The contact law in vectors, in the same operations as core/model/contact_law.hpp. Included once per SIMD target.
#if defined(HERTZLINE_CONTACT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_CONTACT_INL
#undef HERTZLINE_CONTACT_INL
#else
#define HERTZLINE_CONTACT_INL
#endif

#include "core/model/contact_law.hpp"
#include "core/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// How far a contact is pressed [m]: its overlap, zero when apart.
HWY_INLINE Vec pressed(Vec overlap) {
    return Max(overlap, zero());
}

/// Hertz's law k delta^(3/2) for contacts that are pressed.
HWY_INLINE Vec hertz(Vec stiffness, Vec delta) {
    return stiffness * delta * Sqrt(delta);
}

/// Elastic force [N] at an overlap [m]; zero when apart.
HWY_INLINE Vec elastic_force(Vec stiffness, Vec overlap) {
    return hertz(stiffness, pressed(overlap));
}
/// The same, the root of the pressed overlap known.
HWY_INLINE Vec elastic_force(Vec stiffness, Vec overlap, Vec root) {
    return stiffness * pressed(overlap) * root;
}

/// Its slope 3/2 k sqrt(delta) [N/m].
HWY_INLINE Vec tangent_stiffness(Vec stiffness, Vec overlap) {
    return splat(1.5) * stiffness * Sqrt(pressed(overlap));
}

/// delta^q of a law's damping force, for contacts that are pressed and laws with q > 0.
HWY_INLINE Vec damping_power(DampingLaw law, Vec delta) {
    if (law == DampingLaw::dashpot) {
        return splat(1.0);
    }
    const Vec root = Sqrt(delta);
    return law == DampingLaw::tsuji ? Sqrt(root) : root;
}

/// Energy stored (2/5) k delta^(5/2) [J].
HWY_INLINE Vec elastic_energy(Vec stiffness, Vec overlap) {
    return splat(0.4) * elastic_force(stiffness, overlap) * pressed(overlap);
}

/// The smaller of a magnitude and |w|, with the sign of w.
HWY_INLINE Vec at_most(Vec magnitude, Vec w) {
#if HWY_TARGET <= HWY_AVX3
    constexpr int smaller_magnitude_first_sign = 2;
    return Vec{_mm512_range_pd(w.raw, magnitude.raw, smaller_magnitude_first_sign)};
#else
    return hn::CopySignToAbs(Min(magnitude, Abs(w)), w);
#endif
}

/// A relative velocity w [m/s] times the fraction of a step during which its contact is closed,
/// clamp(1/2 + delta/(|w| h), 0, 1). @param shift overlap at mid-step over the step, delta/h [m/s]
HWY_INLINE Vec weighed_by_contact(Vec w, Vec shift) {
    return at_most(Max(MulAdd(splat(0.5), Abs(w), shift), zero()), w);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
