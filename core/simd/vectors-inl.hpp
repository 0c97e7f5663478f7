// Vectors of doubles and the operations of formulas on them. Included once per SIMD target.
//
// + - * / round after each operation, MulAdd and its kin once: which of the two stands in a formula is part
// of the result.
#if defined(HERTZLINE_VECTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_VECTORS_INL
#undef HERTZLINE_VECTORS_INL
#else
#define HERTZLINE_VECTORS_INL
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using hn::Abs;
using hn::AllFalse;
using hn::AllTrue;
using hn::And;
using hn::AndNot;
using hn::CountTrue;
using hn::Eq;
using hn::GetLane;
using hn::Gt;
using hn::IfThenElse;
using hn::IfThenElseZero;
using hn::IfThenZeroElse;
using hn::Le;
using hn::Lt;
using hn::Max;
using hn::Min;
using hn::MulAdd;
using hn::MulSub;
using hn::Ne;
using hn::Neg;
using hn::NegMulAdd;
using hn::Not;
using hn::Or;
using hn::Sqrt;
using hn::Xor;

using Doubles = hn::ScalableTag<double>;
using Vec = hn::Vec<Doubles>;
using Flags = hn::Mask<Doubles>;

HWY_INLINE std::size_t lanes() {
    return hn::Lanes(Doubles());
}
HWY_INLINE Vec zero() {
    return hn::Zero(Doubles());
}
/// The value in all lanes.
HWY_INLINE Vec splat(double value) {
    return hn::Set(Doubles(), value);
}
/// 1 where a flag is set, else 0: flags that live in a column.
HWY_INLINE Vec one_where(Flags flags) {
    return IfThenElseZero(flags, splat(1.0));
}
HWY_INLINE Vec load_row(const double* from) {
    return hn::Load(Doubles(), from);
}
HWY_INLINE void store_row(Vec values, double* to) {
    hn::Store(values, Doubles(), to);
}
HWY_INLINE bool any(Flags flags) {
    return !AllFalse(Doubles(), flags);
}
HWY_INLINE bool all(Flags flags) {
    return AllTrue(Doubles(), flags);
}
HWY_INLINE Flags none() {
    return Gt(zero(), zero());
}
HWY_INLINE double largest_lane(Vec values) {
    return GetLane(hn::MaxOfLanes(Doubles(), values));
}
HWY_INLINE double smallest_lane(Vec values) {
    return GetLane(hn::MinOfLanes(Doubles(), values));
}

/// Moves lanes round by one.
class Rotation {
public:
    HWY_INLINE Rotation() {
        HWY_ALIGN std::int64_t up[hn::MaxLanes(Doubles())];
        HWY_ALIGN std::int64_t down[hn::MaxLanes(Doubles())];
        for (std::size_t i = 0; i < lanes(); ++i) {
            up[i] = static_cast<std::int64_t>((i + lanes() - 1) % lanes());
            down[i] = static_cast<std::int64_t>((i + 1) % lanes());
        }
        up_ = hn::SetTableIndices(Doubles(), up);
        down_ = hn::SetTableIndices(Doubles(), down);
    }
    /// Lane i gets the value of lane i - 1, the first that of the last.
    HWY_INLINE Vec up(Vec v) const { return hn::TableLookupLanes(v, up_); }
    /// Lane i gets the value of lane i + 1, the last that of the first.
    HWY_INLINE Vec down(Vec v) const { return hn::TableLookupLanes(v, down_); }

private:
    using Indices = decltype(hn::SetTableIndices(Doubles(), static_cast<const std::int64_t*>(nullptr)));
    Indices up_, down_;
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
