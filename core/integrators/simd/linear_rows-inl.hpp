// Rows of a chain in line (folded_chain.hpp). Included once per SIMD target.
#if defined(HERTZLINE_LINEAR_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_LINEAR_ROWS_INL
#undef HERTZLINE_LINEAR_ROWS_INL
#else
#define HERTZLINE_LINEAR_ROWS_INL
#endif

#include "core/integrators/simd/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Neighbours of a row in line, which lie partly in the row beside it; and what else is better said to
/// AVX-512 in its own words, for which Highway has none.
class LinearRows {
public:
    HWY_INLINE LinearRows() {
        HWY_ALIGN std::int64_t up[hn::MaxLanes(Doubles())];
        HWY_ALIGN std::int64_t down[hn::MaxLanes(Doubles())];
        const std::size_t lanes = hn::Lanes(Doubles());
        for (std::size_t i = 0; i < lanes; ++i) {
            up[i] = static_cast<std::int64_t>((i + lanes - 1) % lanes);
            down[i] = static_cast<std::int64_t>((i + 1) % lanes);
        }
        up_ = hn::SetTableIndices(Doubles(), up);
        down_ = hn::SetTableIndices(Doubles(), down);
    }
    /// Values to the left of a row's; of the row before only the last counts.
    HWY_INLINE Vec left(Vec before, Vec row) const {
#if HWY_TARGET <= HWY_AVX3
        return Vec{_mm512_castsi512_pd(
            _mm512_alignr_epi64(_mm512_castpd_si512(row.raw), _mm512_castpd_si512(before.raw), 7))};
#else
        const Flags first = hn::FirstN(Doubles(), 1);
        return hn::IfThenElse(first, hn::TableLookupLanes(before, up_), hn::TableLookupLanes(row, up_));
#endif
    }
    /// Values to the right of a row's; of the row after only the first counts.
    HWY_INLINE Vec right(Vec row, Vec after) const {
#if HWY_TARGET <= HWY_AVX3
        return Vec{_mm512_castsi512_pd(
            _mm512_alignr_epi64(_mm512_castpd_si512(after.raw), _mm512_castpd_si512(row.raw), 1))};
#else
        const Flags own = hn::FirstN(Doubles(), hn::Lanes(Doubles()) - 1);
        return hn::IfThenElse(own, hn::TableLookupLanes(row, down_), hn::TableLookupLanes(after, down_));
#endif
    }
    /// The smaller of a magnitude and |w|, with the sign of w.
    static HWY_INLINE Vec at_most(Vec magnitude, Vec w) {
#if HWY_TARGET <= HWY_AVX3
        constexpr int smaller_magnitude_first_sign = 2;
        return Vec{_mm512_range_pd(w.raw, magnitude.raw, smaller_magnitude_first_sign)};
#else
        return hn::CopySignToAbs(hn::Min(magnitude, hn::Abs(w)), w);
#endif
    }

private:
    Rotation up_, down_;
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
