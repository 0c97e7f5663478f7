#include "stream/threads.hpp"

#include <gtest/gtest.h>

namespace hertzline::test {

using namespace stream;
namespace {

TEST(ThreadOptions, AProcessorThatDoesNotExistIsNamedWithThoseThatDo) {
    EXPECT_FALSE(cpu_fault(0));
    ASSERT_TRUE(cpu_fault(-1));
    EXPECT_EQ(cpu_fault(100'000)->rfind("found 100000, allowed: 0 to ", 0), 0U) << *cpu_fault(100'000);
}

}  // namespace
}  // namespace hertzline::test
