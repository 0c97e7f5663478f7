// The horn's work, net and back and forth, in lane 0. Included once per SIMD target.
#if defined(HERTZLINE_WORK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_WORK_INL
#undef HERTZLINE_WORK_INL
#else
#define HERTZLINE_WORK_INL
#endif

#include "core/integrators/simd/vectors-inl.hpp"
#include "core/integrators/simd_chain.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

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

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
