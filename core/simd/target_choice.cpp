#include "core/simd/target_choice.hpp"

#include <atomic>

#include "core/simd/simd_targets.hpp"
// before targets.h
#include <hwy/targets.h>

namespace hertzline::kernels {

namespace {

/// Whether this processor and its system have the instructions that a target's kernels were compiled for. Highway compiles the
/// widest two of x86 for x86-64-v3 and x86-64-v4, whose features always come together; the compilers know some of them by name.
bool is_supported(std::int64_t target) noexcept {
#if HWY_ARCH_X86
    const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
                    __builtin_cpu_supports("aes") && __builtin_cpu_supports("pclmul");
    if (target == HWY_AVX2) {
        return v3;
    }
    if (target == HWY_AVX3) {
        return v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
               __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512bw");
    }
#endif
    return target == HWY_STATIC_TARGET;  // the program itself is compiled for it
}

/// The lowest bit is the widest.
std::vector<std::int64_t> targets() {
    std::vector<std::int64_t> found;
    constexpr int bits = 63;
    for (int bit = 0; bit < bits; ++bit) {
        const std::int64_t target = (std::int64_t{1} << bit) & HWY_TARGETS;
        if (target != 0 && is_supported(target)) {
            found.push_back(target);
        }
    }
    return found;
}

const std::vector<std::int64_t>& supported_targets() {
    static const std::vector<std::int64_t> supported = targets();
    return supported;
}

std::atomic<std::int64_t>& chosen() {
    static std::atomic<std::int64_t> target{supported_targets().front()};
    return target;
}

}  // namespace

std::int64_t chosen_target() noexcept {
    return chosen().load(std::memory_order_relaxed);
}

const std::vector<std::string>& kernel_targets() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const std::int64_t target : supported_targets()) {
            all.emplace_back(hwy::TargetName(target));
        }
        return all;
    }();
    return names;
}

bool pin_kernel_target(std::string_view name) {
    for (const std::int64_t target : supported_targets()) {
        if (name == hwy::TargetName(target)) {
            chosen().store(target, std::memory_order_relaxed);
            return true;
        }
    }
    return false;
}

}  // namespace hertzline::kernels
