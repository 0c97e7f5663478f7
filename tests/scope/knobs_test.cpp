#include "scope/server/knobs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hertzline::scope {
namespace {

TEST(ControlLink, AQuestionThatWasSentMayStillBeHeardWhenItIsGivenUp) {
    ControlLink link("ipc:///tmp/nobody-listens-here", {});
    link.ask({{"set", 1}}, 1);
    link.ask({{"set", 2}}, 2);
    link.give_up("nothing is changed");
    const auto answers = link.answers();
    ASSERT_EQ(answers.size(), 2U);
    EXPECT_THAT(answers[0].answer.dump(), testing::HasSubstr("may still take effect"));
    EXPECT_THAT(answers[1].answer.dump(), testing::HasSubstr("nothing is changed"));
    EXPECT_TRUE(link.idle());
}

}  // namespace
}  // namespace hertzline::scope
