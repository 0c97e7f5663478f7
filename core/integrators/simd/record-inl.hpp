// Records of a kernel beside the motion: rows of a trace, and the horn's work. Included once per SIMD target.
#if defined(HERTZLINE_RECORD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_RECORD_INL
#undef HERTZLINE_RECORD_INL
#else
#define HERTZLINE_RECORD_INL
#endif

#include <algorithm>

#include <hwy/highway.h>

#include "core/integrators/kernels.hpp"
#include "core/integrators/simd_chain.hpp"
#include "core/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// The horn's work, net and back and forth, in lane 0.
class HornWork {
public:
    explicit HWY_INLINE HornWork(const SimdChain& chain)
        : net_(load_row(chain.column(ChainField::work))),
          gross_(load_row(chain.column(ChainField::gross_work))) {}

    /// @param done work over some time [J]
    HWY_INLINE void add(Vec done) {
        net_ = net_ + done;
        gross_ = gross_ + Abs(done);
    }
    HWY_INLINE void save(const SimdChain& chain) const {
        store_row(net_, chain.column(ChainField::work));
        store_row(gross_, chain.column(ChainField::gross_work));
    }

private:
    Vec net_;
    Vec gross_;
};

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
