// A modal plate behind a chain that lies in memory (plate_steps.hpp): where kernels meet it. Included once per SIMD target.
//
// Chains in registers (K > 0) have none: all of this is nothing there.
#if defined(HERTZLINE_PLATE_BODY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_PLATE_BODY_INL
#undef HERTZLINE_PLATE_BODY_INL
#else
#define HERTZLINE_PLATE_BODY_INL
#endif

#include "core/integrators/simd/striped_rows-inl.hpp"
#include "core/plate/plate_steps.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Null: there is none.
template <std::size_t K>
HWY_INLINE PlateSteps* plate_behind(const StripedRows<K>& rows) {
    if constexpr (K == 0) {
        return rows.chain().plate;
    } else {
        return nullptr;
    }
}

/// A value of a column in memory.
template <std::size_t K>
HWY_INLINE double value_in(const Col<K>& col, std::size_t slot) {
    if constexpr (K == 0) {
        return col.rows[slot];
    } else {
        return 0;
    }
}
template <std::size_t K>
HWY_INLINE void put_in(const Col<K>& col, std::size_t slot, double value) {
    if constexpr (K == 0) {
        col.rows[slot] = value;
    }
}

/// The last body goes where the plate's states say.
template <std::size_t K>
HWY_INLINE void follow_plate(const PlateSteps& plate, const Col<K>& x, const Col<K>& v) {
    put_in(x, plate.end_slot, plate.displacement());
    put_in(v, plate.end_slot, plate.velocity());
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
