#include "core/simd/target_choice.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "core/integrators/kernels.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {

namespace {

using kernels::kernel_target;
using kernels::kernel_targets;
using kernels::pin_kernel_target;

TEST(TargetChoice, IsTheWidestUntilAnotherIsPinned) {
    const std::vector<std::string> before = kernel_targets();
    ASSERT_THAT(before, testing::Not(testing::IsEmpty()));
    EXPECT_EQ(kernel_target(), before.front());
    std::size_t lanes = kernels::kernel_lanes();
    for (const std::string& name : before) {
        EXPECT_TRUE(pin_kernel_target(name));
        EXPECT_EQ(kernel_target(), name);
        EXPECT_LE(kernels::kernel_lanes(), lanes);
        lanes = kernels::kernel_lanes();
        EXPECT_EQ(kernel_targets(), before) << "pinned to " << name;
    }
    EXPECT_TRUE(pin_kernel_target(before.front()));
    EXPECT_EQ(kernel_target(), before.front());
}

#if HWY_ARCH_X86
// The program does not use Highway's library, which detects the same.
TEST(TargetChoice, IsAmongThoseThatHighwayFindsHere) {
    void* const library = ::dlopen("libhwy.so.1", RTLD_NOW | RTLD_LOCAL);
    ASSERT_NE(library, nullptr);
    const auto supported =
        reinterpret_cast<std::int64_t (*)()>(::dlsym(library, "_ZN3hwy16SupportedTargetsEv"));
    ASSERT_NE(supported, nullptr);
    for (const auto& [target, name] : {std::pair(HWY_AVX2, "AVX2"), std::pair(HWY_AVX3, "AVX3")}) {
        if (sanitized && target == HWY_AVX3) {
            continue;  // core/CMakeLists.txt leaves it out
        }
        EXPECT_EQ((supported() & target) != 0, std::ranges::count(kernel_targets(), name) == 1) << name;
    }
}
#endif

TEST(TargetChoice, KnowsNoOtherNames) {
    const std::string before = kernel_target();
    for (const char* name : {"", "AVX9", "avx2", "RVV"}) {
        EXPECT_FALSE(pin_kernel_target(name)) << name;
        EXPECT_EQ(kernel_target(), before);
    }
}

}  // namespace

}  // namespace hertzline::test
