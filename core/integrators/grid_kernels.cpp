// One copy of the integrators per instruction set; the widest that this processor has is chosen at run time.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/integrators/grid_kernels.cpp"
#include "core/simd/simd_targets.hpp"
// before highway.h
#include <hwy/foreach_target.h>
// after foreach_target
#include <hwy/highway.h>

#include "core/integrators/chin4a/chin4a-inl.hpp"
#include "core/integrators/kernels.hpp"
#include "core/integrators/leapfrog/leapfrog-inl.hpp"
#include "core/integrators/leapfrog/leapfrog_sweep-inl.hpp"
#include "core/simd/dispatch.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

template <template <std::size_t> class Pick>
Kernel for_rows(std::size_t rows) {
    switch (rows) {
        case 1:
            return Pick<1>::kernel;
        case 2:
            return Pick<2>::kernel;
        case 4:
            return Pick<4>::kernel;
        case 8:
            return Pick<8>::kernel;
        default:
            return Pick<0>::kernel;
    }
}

template <std::size_t K>
struct LeapfrogRows {
    static constexpr Kernel kernel = advance_leapfrog<K>;
};
template <>
struct LeapfrogRows<0> {
    static constexpr Kernel kernel = advance_leapfrog_linear;
};
template <std::size_t K>
struct Chin4aRows {
    static constexpr Kernel kernel = advance_chin4a<K>;
};

Kernel pick(Integrator integrator, std::size_t rows) {
    switch (integrator) {
        case Integrator::leapfrog:
            return for_rows<LeapfrogRows>(rows);
        case Integrator::chin4a:
            return for_rows<Chin4aRows>(rows);
        case Integrator::taylor8:
        case Integrator::taylor12:
            break;  // series_kernels.cpp
    }
    return nullptr;
}

std::size_t vector_lanes() {
    return lanes();
}

const char* target() {
    return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hertzline::kernels {

HERTZLINE_EXPORT(pick);
HERTZLINE_EXPORT(vector_lanes);
HERTZLINE_EXPORT(target);

Kernel kernel(Integrator integrator, std::size_t rows) noexcept {
    return HERTZLINE_DISPATCH(pick)(integrator, rows);
}

std::size_t kernel_lanes() noexcept {
    return HERTZLINE_DISPATCH(vector_lanes)();
}

const char* kernel_target() noexcept {
    return HERTZLINE_DISPATCH(target)();
}

}  // namespace hertzline::kernels
#endif
