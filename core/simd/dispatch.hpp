#pragma once
// Calls of the copy of a function that was compiled for the chosen instruction set. Included after highway.h, used behind HWY_ONCE.
//
// Highway's HWY_EXPORT and HWY_DYNAMIC_DISPATCH do the same, and need libhwy, whose static initialiser measures the clock: 5 ms at
// the start of every program that is linked with it (1.0.3). So the tables are Highway's, and the choice is target_choice.hpp's.

#include <bit>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "core/simd/target_choice.hpp"

// NOLINTBEGIN(cppcoreguidelines-macro-usage)
#if HWY_IDE || ((HWY_TARGETS & (HWY_TARGETS - 1)) == 0)

#define HERTZLINE_EXPORT(function)                  \
    static decltype(&HWY_STATIC_DISPATCH(function)) \
        const function##_of_targets[1] = {&HWY_STATIC_DISPATCH(function)}
#define HERTZLINE_DISPATCH(function) (*function##_of_targets[0])

#else

namespace hertzline::kernels {

/// Where a target stands in a table: those that are chosen among come first, the fallback last.
inline std::size_t place_in_table(std::int64_t target) noexcept {
    const auto place = static_cast<std::uint64_t>(HWY_CHOSEN_TARGET_SHIFT(target)) >> 1;
    return place != 0 ? static_cast<std::size_t>(std::countr_zero(place)) : HWY_MAX_DYNAMIC_TARGETS;
}

}  // namespace hertzline::kernels

#define HERTZLINE_EXPORT(function)                  \
    static decltype(&HWY_STATIC_DISPATCH(function)) \
        const function##_of_targets[] = {HWY_CHOOSE_TARGET_LIST(function), HWY_CHOOSE_FALLBACK(function)}
#define HERTZLINE_DISPATCH(function) \
    (*function##_of_targets[hertzline::kernels::place_in_table(hertzline::kernels::chosen_target())])

#endif
// NOLINTEND(cppcoreguidelines-macro-usage)
