#include "core/model/low_pass_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/model/low_pass_kernel.cpp"
#include "core/simd/simd_targets.hpp"
// before highway.h
#include <hwy/foreach_target.h>
// after foreach_target
#include <hwy/highway.h>

#include "core/simd/dispatch.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void sum_taps(const double* samples, const double* taps, std::size_t count, const std::ptrdiff_t* places,
              double* values) noexcept {
    const hn::CappedTag<double, low_pass_block / 4> doubles;
    const std::size_t lanes = hn::Lanes(doubles);
    for (std::size_t knot = 0; knot < low_pass_block; knot += 4 * lanes) {
        const double* const from = samples + knot;
        const auto at = [&](std::ptrdiff_t place, std::size_t vector) {
            return hn::LoadU(doubles, from + place + vector * lanes);
        };
        auto tap = hn::Set(doubles, taps[0]);
        auto sum_0 = hn::Mul(tap, at(places[0], 0));
        auto sum_1 = hn::Mul(tap, at(places[0], 1));
        auto sum_2 = hn::Mul(tap, at(places[0], 2));
        auto sum_3 = hn::Mul(tap, at(places[0], 3));
        for (std::size_t j = 1; j < count; ++j) {
            tap = hn::Set(doubles, taps[j]);
            const std::ptrdiff_t after = places[j];
            const std::ptrdiff_t before = *(places - j);
            sum_0 = hn::Add(sum_0, hn::Mul(tap, hn::Add(at(after, 0), at(before, 0))));
            sum_1 = hn::Add(sum_1, hn::Mul(tap, hn::Add(at(after, 1), at(before, 1))));
            sum_2 = hn::Add(sum_2, hn::Mul(tap, hn::Add(at(after, 2), at(before, 2))));
            sum_3 = hn::Add(sum_3, hn::Mul(tap, hn::Add(at(after, 3), at(before, 3))));
        }
        hn::StoreU(sum_0, doubles, values + knot);
        hn::StoreU(sum_1, doubles, values + knot + lanes);
        hn::StoreU(sum_2, doubles, values + knot + 2 * lanes);
        hn::StoreU(sum_3, doubles, values + knot + 3 * lanes);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hertzline::kernels {

HERTZLINE_EXPORT(sum_taps);

void low_pass(const double* samples, const double* taps, std::size_t count, const std::ptrdiff_t* places,
              double* values) noexcept {
    HERTZLINE_DISPATCH(sum_taps)(samples, taps, count, places, values);
}

}  // namespace hertzline::kernels
#endif
