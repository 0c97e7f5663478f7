#include "core/integrators/simd/target_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/integrators/kernels.hpp"

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

TEST(TargetChoice, KnowsNoOtherNames) {
    const std::string before = kernel_target();
    for (const char* name : {"", "AVX9", "avx2", "RVV"}) {
        EXPECT_FALSE(pin_kernel_target(name)) << name;
        EXPECT_EQ(kernel_target(), before);
    }
}

}  // namespace

}  // namespace hertzline::test
