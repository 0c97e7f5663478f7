// A sweep as rank 0 tells other ranks of it, which may be other programs on other processors.

#include "apps/mpi/shared_sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/integrators/kernels.hpp"
#include "core/integrators/simd/target_choice.hpp"
#include "core/scene/json.hpp"
#include "tests/support/error_of.hpp"

namespace hertzline::test {

namespace {

using app::shared_sweep;
using app::shared_text;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

studies::Sweep some_sweep() {
    auto plan = studies::SweepPlan::make({}, {{"chain.preload_n=0.1..1:log:7"}, "", "", std::nullopt});
    studies::PointDemand demand;
    demand.columns = measures::number_columns({}, false);
    return {*std::move(plan), demand, {}};
}

/// As a rank 0 tells of it whose program differs in this.
std::string told_with(const char* key, const std::string& value) {
    auto json = Json::parse(shared_text(some_sweep(), 2));
    auto journal = Json::parse(json["journal"].get<std::string>());
    journal[key] = value;
    json["journal"] = journal.dump();
    return json.dump();
}

TEST(SharedSweepOfRanks, IsTheSameEverywhere) {
    const app::SharedSweep shared = shared_sweep(shared_text(some_sweep(), 2));
    EXPECT_EQ(shared.threads, 2);
    EXPECT_EQ(studies::journal_text(shared.sweep), studies::journal_text(some_sweep()));
    for (std::int64_t point = 0; point < 7; ++point) {
        EXPECT_EQ(shared.sweep.plan.scene(point), some_sweep().plan.scene(point));
    }
}

TEST(SharedSweepOfRanks, TakesTheInstructionSetOfRankZero) {
    const std::string widest = kernels::kernel_targets().front();
    const std::string narrowest = kernels::kernel_targets().back();
    ASSERT_TRUE(kernels::pin_kernel_target(narrowest));
    const std::string text = shared_text(some_sweep(), 1);
    ASSERT_TRUE(kernels::pin_kernel_target(widest));
    EXPECT_EQ(kernels::kernel_target(), widest);
    shared_sweep(text);
    EXPECT_EQ(kernels::kernel_target(), narrowest);
    kernels::pin_kernel_target(widest);
}

TEST(SharedSweepOfRanks, OfAnotherProgramIsRefused) {
    EXPECT_THAT(error_of([] { shared_sweep(told_with("simd_target", "AVX9")); }),
                AllOf(HasSubstr("found no AVX9"), HasSubstr("--target with one of"),
                      HasSubstr(kernels::kernel_targets().back())));
    EXPECT_THAT(error_of([] { shared_sweep(told_with("version", "0.0.1")); }),
                AllOf(HasSubstr("the version"), HasSubstr("0.0.1"), HasSubstr("on all ranks")));
    EXPECT_THAT(error_of([] { shared_sweep(told_with("compiler", "cc")); }), HasSubstr("the compiler"));
    EXPECT_THAT(error_of([] { shared_sweep(R"({"journal": "{}", "threads": 1})"); }), Not(IsEmpty()));
}

}  // namespace

}  // namespace hertzline::test
