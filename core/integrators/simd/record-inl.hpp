// Rows of a trace. Included once per SIMD target.
#if defined(HERTZLINE_RECORD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_RECORD_INL
#undef HERTZLINE_RECORD_INL
#else
#define HERTZLINE_RECORD_INL
#endif

#include <algorithm>

#include <hwy/highway.h>

#include "core/integrators/simd_chain.hpp"
#include "core/integrators/trace.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Adds one row to the trace from the columns x, v and total_accel in memory.
HWY_INLINE void record(const SimdChain& chain, Trace& trace, std::int64_t step, double fraction) {
    const double* const x = chain.column(ChainField::x);
    const double* const v = chain.column(ChainField::v);
    const double* const a = chain.column(ChainField::total_accel);
    const auto bodies = static_cast<std::size_t>(trace.bodies - trace.first_body);
    double* const row = trace.rows + trace.count * trace.row_size();
    std::size_t i = 0;
    for (Eigen::Index b = trace.first_body; b < std::min(trace.bodies, chain.active()); ++b, ++i) {
        const std::size_t s = chain.slot(b);
        row[i] = x[s];
        row[i + bodies] = v[s];
        row[i + 2 * bodies] = a[s];
    }
    for (; i < bodies; ++i) {
        row[i] = row[i + bodies] = row[i + 2 * bodies] = 0;  // not laid out: at rest
    }
    trace.steps[trace.count] = step;
    trace.fractions[trace.count] = fraction;
    ++trace.count;
    if (fraction == 0) {
        trace.next = step + trace.every;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
