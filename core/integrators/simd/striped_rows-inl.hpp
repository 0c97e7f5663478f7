// A striped chain (simd_chain.hpp) in vector registers: columns, neighbours, horn. Included once per SIMD target.
#if defined(HERTZLINE_STRIPED_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_STRIPED_ROWS_INL
#undef HERTZLINE_STRIPED_ROWS_INL
#else
#define HERTZLINE_STRIPED_ROWS_INL
#endif

#include "core/integrators/simd_chain.hpp"
#include "core/simd/vectors-inl.hpp"

// Unrolled by the compiler where n is a constant, so that the rows of a short chain stay in registers.
#define HERTZLINE_EACH_ROW(k, n) for (std::size_t k = 0; k < (n); ++k)

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// One column of a striped chain: K rows held in registers, or (K = 0) a stretch of memory.
template <std::size_t K>
struct Col {
    Vec row[K];
    HWY_INLINE Vec operator[](std::size_t k) const { return row[k]; }
    HWY_INLINE void set(std::size_t k, Vec value) { row[k] = value; }
};
template <>
struct Col<0> {
    double* rows;
    HWY_INLINE Vec operator[](std::size_t k) const { return load_row(rows + k * lanes()); }
    HWY_INLINE void set(std::size_t k, Vec value) const { store_row(value, rows + k * lanes()); }
};

/// Access to a SimdChain row by row. A column is a ChainField or a kernel's own Scratch.
template <std::size_t K>
class StripedRows {
public:
    explicit HWY_INLINE StripedRows(SimdChain& chain) : chain_(&chain) {
        horn_lane_ = IfThenElseZero(hn::FirstN(Doubles(), 1), splat(1.0));
    }

    HWY_INLINE std::size_t count() const { return K > 0 ? K : chain_->rows(); }
    HWY_INLINE SimdChain& chain() const { return *chain_; }

    /// The column's values. In memory (K = 0) this is the column itself.
    template <class Column>
    HWY_INLINE Col<K> load(Column c) const {
        if constexpr (K == 0) {
            return {begin(c)};
        } else {
            Col<K> col;
            HERTZLINE_EACH_ROW(k, K) col.row[k] = load_row(begin(c) + k * lanes());
            return col;
        }
    }
    template <class Column>
    HWY_INLINE void store(Column c, const Col<K>& col) const {
        if constexpr (K == 0) {
            copy(Col<0>{begin(c)}, col);
        } else {
            HERTZLINE_EACH_ROW(k, K) store_row(col.row[k], begin(c) + k * lanes());
        }
    }
    /// Room for intermediate values; registers need no particular column.
    template <class Scratch>
    HWY_INLINE Col<K> scratch(Scratch c) const {
        if constexpr (K == 0) {
            return {begin(c)};
        } else {
            Col<K> col;
            HERTZLINE_EACH_ROW(k, K) col.row[k] = zero();
            return col;
        }
    }
    HWY_INLINE void fill(Col<K>& col, double value) const {
        HERTZLINE_EACH_ROW(k, count()) col.set(k, splat(value));
    }
    /// dst = src, value by value.
    template <class Dst>
    HWY_INLINE void copy(Dst&& dst, const Col<K>& src) const {
        HERTZLINE_EACH_ROW(k, count()) dst.set(k, src[k]);
    }

    /// Values of the left neighbours of row k; the first body's is the last slot's, a pad's zero.
    HWY_INLINE Vec left(const Col<K>& col, std::size_t k) const {
        return k > 0 ? col[k - 1] : rotation_.up(col[count() - 1]);
    }
    /// Values of the right neighbours of row k; meaningless in the last slot, which is a pad without mobility.
    HWY_INLINE Vec right(const Col<K>& col, std::size_t k) const {
        return k + 1 < count() ? col[k + 1] : rotation_.down(col[0]);
    }
    /// All values one body further on: each body gets its left neighbour's.
    HWY_INLINE Col<K> shifted_up(const Col<K>& col) const {
        Col<K> shifted;
        HERTZLINE_EACH_ROW(k, count()) shifted.set(k, left(col, k));
        return shifted;
    }
    /// Each body gets its right neighbour's.
    HWY_INLINE Col<K> shifted_down(const Col<K>& col) const {
        Col<K> shifted;
        HERTZLINE_EACH_ROW(k, count()) shifted.set(k, right(col, k));
        return shifted;
    }
    /// left - self, with the horn's value as the first body's left neighbour. The rotation takes longest, so
    /// all else is done beside it.
    HWY_INLINE Vec difference(const Col<K>& col, std::size_t k, double horn_value) const {
        if (k > 0) {
            return left(col, k) - col[k];
        }
        return left(col, k) + (horn(horn_value) - col[k]);
    }
    /// offset + difference: exactly offset for bodies at rest.
    HWY_INLINE Vec difference(Vec offset, const Col<K>& col, std::size_t k, double horn_value) const {
        const Vec beside = k > 0 ? offset : offset + horn(horn_value);
        return left(col, k) + (beside - col[k]);
    }
    /// The horn's value in lane 0 of row 0, zero in all other lanes.
    HWY_INLINE Vec horn(double value) const { return horn_lane_ * splat(value); }

private:
    HWY_INLINE double* begin(ChainField c) const { return chain_->column(c); }
    template <class Scratch>
    HWY_INLINE double* begin(Scratch c) const {
        static_assert(static_cast<std::size_t>(Scratch::count) <= SimdChain::scratch_columns);
        return chain_->scratch(static_cast<std::size_t>(c));
    }

    SimdChain* chain_;
    Rotation rotation_;
    Vec horn_lane_;
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
