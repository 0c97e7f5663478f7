// Rows of a linear chain (simd_chain.hpp). Included once per SIMD target.
#if defined(HERTZLINE_LINEAR_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_LINEAR_ROWS_INL
#undef HERTZLINE_LINEAR_ROWS_INL
#else
#define HERTZLINE_LINEAR_ROWS_INL
#endif

#include "core/integrators/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Neighbours of a row, which lie partly in the row beside it. AVX-512 shifts two registers in one
/// instruction, for which Highway has no word.
class LinearRows {
public:
    // NOLINTNEXTLINE(modernize-use-equals-default): a defaulted one would be compiled for the baseline
    HWY_INLINE LinearRows() {}

    /// Values to the left of a row's; of the row before only the last counts.
    HWY_INLINE Vec left(Vec before, Vec row) const {
#if HWY_TARGET <= HWY_AVX3
        return Vec{_mm512_castsi512_pd(
            _mm512_alignr_epi64(_mm512_castpd_si512(row.raw), _mm512_castpd_si512(before.raw), 7))};
#else
        const Flags first = hn::FirstN(Doubles(), 1);
        return IfThenElse(first, rotation_.up(before), rotation_.up(row));
#endif
    }
    /// Values to the right of a row's; of the row after only the first counts.
    HWY_INLINE Vec right(Vec row, Vec after) const {
#if HWY_TARGET <= HWY_AVX3
        return Vec{_mm512_castsi512_pd(
            _mm512_alignr_epi64(_mm512_castpd_si512(after.raw), _mm512_castpd_si512(row.raw), 1))};
#else
        const Flags own = hn::FirstN(Doubles(), lanes() - 1);
        return IfThenElse(own, rotation_.down(row), rotation_.down(after));
#endif
    }

private:
    Rotation rotation_;
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
