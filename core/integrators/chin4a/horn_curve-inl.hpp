// The horn's motion within a step. Included once per SIMD target.
#if defined(HERTZLINE_HORN_CURVE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_HORN_CURVE_INL
#undef HERTZLINE_HORN_CURVE_INL
#else
#define HERTZLINE_HORN_CURVE_INL
#endif

#include "core/integrators/simd/vectors-inl.hpp"
#include "core/model/tone_burst.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// The horn over a part of a step, as the quintic through its motion at both ends (error 1e-11 of the
/// amplitude at 200 ns).
class HornCurve {
public:
    HWY_INLINE HornCurve(const HornMotion& from, const HornMotion& to, double duration_s)
        : duration_(duration_s), from_(from) {
        const double d = duration_s;
        const double x = to.x - from.x - d * (from.v + 0.5 * d * from.a);
        const double v = d * (to.v - from.v - d * from.a);
        const double a = d * d * (to.a - from.a);
        using One = hn::CappedTag<double, 1>;  // fused where the instructions have it, as all kernels
        const auto xx = hn::Set(One(), x);
        c3_ = GetLane(MulSub(hn::Set(One(), 10.0), xx, hn::Set(One(), 4 * v))) + 0.5 * a;
        c4_ = GetLane(MulAdd(hn::Set(One(), -15.0), xx, hn::Set(One(), 7 * v))) - a;
        c5_ = 6 * x - 3 * v + 0.5 * a;
    }
    /// @param z fraction of the part
    HWY_INLINE HornMotion at(double z) const {
        const double d = duration_;
        const double t = z * d;
        return {from_.x + t * (from_.v + 0.5 * t * from_.a) + z * z * z * (c3_ + z * (c4_ + z * c5_)),
                from_.v + t * from_.a + z * z * (3 * c3_ + z * (4 * c4_ + z * 5 * c5_)) / d,
                from_.a + z * (6 * c3_ + z * (12 * c4_ + z * 20 * c5_)) / (d * d)};
    }
    HWY_INLINE double duration_s() const { return duration_; }

private:
    double duration_;
    HornMotion from_;
    double c3_, c4_, c5_;
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
