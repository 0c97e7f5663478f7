// The folded chain in vector registers: columns, neighbours, horn, trace. Included once per SIMD target.
#if defined(HERTZLINE_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_LANES_INL
#undef HERTZLINE_LANES_INL
#else
#define HERTZLINE_LANES_INL
#endif

#include <algorithm>
#include <limits>

#include <hwy/highway.h>

#include "core/integrators/simd_chain.hpp"

// Unrolled by the compiler where n is a constant, so that the rows of a short chain stay in registers.
#define HERTZLINE_EACH_ROW(k, n) for (std::size_t k = 0; k < (n); ++k)

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::ScalableTag<double>;
using Vec = hn::Vec<Doubles>;
using Flags = hn::Mask<Doubles>;
using Rotation = decltype(hn::SetTableIndices(Doubles(), static_cast<const std::int64_t*>(nullptr)));

/// One column of the folded chain: K rows held in registers, or (K = 0) a stretch of memory.
template <std::size_t K>
struct Col {
    Vec row[K];
    HWY_INLINE Vec operator[](std::size_t k) const { return row[k]; }
    HWY_INLINE void set(std::size_t k, Vec value) { row[k] = value; }
};
template <>
struct Col<0> {
    double* rows;
    HWY_INLINE Vec operator[](std::size_t k) const {
        return hn::Load(Doubles(), rows + k * hn::Lanes(Doubles()));
    }
    HWY_INLINE void set(std::size_t k, Vec value) const {
        hn::Store(value, Doubles(), rows + k * hn::Lanes(Doubles()));
    }
};

/// Access to a SimdChain row by row.
template <std::size_t K>
class Fold {
public:
    explicit HWY_INLINE Fold(SimdChain& chain) : chain_(&chain) {
        const std::size_t lanes = hn::Lanes(Doubles());
        HWY_ALIGN std::int64_t up[hn::MaxLanes(Doubles())];
        HWY_ALIGN std::int64_t down[hn::MaxLanes(Doubles())];
        for (std::size_t i = 0; i < lanes; ++i) {
            up[i] = static_cast<std::int64_t>((i + lanes - 1) % lanes);
            down[i] = static_cast<std::int64_t>((i + 1) % lanes);
        }
        up_ = hn::SetTableIndices(Doubles(), up);
        down_ = hn::SetTableIndices(Doubles(), down);
        const auto lane0 = hn::FirstN(Doubles(), 1);
        horn_lane_ = hn::IfThenElseZero(lane0, hn::Set(Doubles(), 1.0));
    }

    HWY_INLINE std::size_t rows() const { return K > 0 ? K : chain_->rows(); }
    HWY_INLINE SimdChain& chain() const { return *chain_; }

    /// The column's values. In memory (K = 0) this is the column itself.
    HWY_INLINE Col<K> load(ChainField c) const {
        if constexpr (K == 0) {
            return {chain_->column(c)};
        } else {
            Col<K> col;
            HERTZLINE_EACH_ROW(k, K) col.row[k] = hn::Load(Doubles(), at(c, k));
            return col;
        }
    }
    HWY_INLINE void store(ChainField c, const Col<K>& col) const {
        if constexpr (K == 0) {
            copy(Col<0>{chain_->column(c)}, col);
        } else {
            HERTZLINE_EACH_ROW(k, K) hn::Store(col.row[k], Doubles(), at(c, k));
        }
    }
    /// Room for intermediate values; registers need no particular column.
    HWY_INLINE Col<K> scratch(ChainField c) const {
        if constexpr (K == 0) {
            return {chain_->column(c)};
        } else {
            Col<K> col;
            HERTZLINE_EACH_ROW(k, K) col.row[k] = hn::Zero(Doubles());
            return col;
        }
    }
    /// dst = src, value by value.
    template <class Dst>
    HWY_INLINE void copy(Dst&& dst, const Col<K>& src) const {
        HERTZLINE_EACH_ROW(k, rows()) dst.set(k, src[k]);
    }

    /// Values of the left neighbours of row k; the first body's is the last slot's, a pad's zero.
    HWY_INLINE Vec left(const Col<K>& col, std::size_t k) const {
        return k > 0 ? col[k - 1] : hn::TableLookupLanes(col[rows() - 1], up_);
    }
    /// Values of the right neighbours of row k; meaningless in the last slot, which is a pad without
    /// mobility.
    HWY_INLINE Vec right(const Col<K>& col, std::size_t k) const {
        return k + 1 < rows() ? col[k + 1] : hn::TableLookupLanes(col[0], down_);
    }
    /// left - self, with the horn's value as the first body's left neighbour. The rotation takes longest, so
    /// all else is done beside it.
    HWY_INLINE Vec difference(const Col<K>& col, std::size_t k, double horn_value) const {
        if (k > 0) {
            return hn::Sub(left(col, k), col[k]);
        }
        return hn::Add(left(col, k), hn::Sub(horn(horn_value), col[k]));
    }
    /// offset + difference: exactly offset for bodies at rest.
    HWY_INLINE Vec difference(Vec offset, const Col<K>& col, std::size_t k, double horn_value) const {
        const Vec beside = k > 0 ? offset : hn::Add(offset, horn(horn_value));
        return hn::Add(left(col, k), hn::Sub(beside, col[k]));
    }
    /// The horn's value in lane 0 of row 0, zero in all other lanes.
    HWY_INLINE Vec horn(double value) const { return hn::Mul(horn_lane_, hn::Set(Doubles(), value)); }

private:
    HWY_INLINE double* at(ChainField c, std::size_t k) const {
        return chain_->column(c) + k * hn::Lanes(Doubles());
    }

    SimdChain* chain_;
    Rotation up_, down_;
    Vec horn_lane_;
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
        row[i] = row[i + bodies] = row[i + 2 * bodies] = 0;  // not folded: at rest
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
