#include "measures/provenance.hpp"

#include <gtest/gtest.h>

namespace hertzline::test {

using namespace measures;
namespace {

TEST(Provenance, TellsHowOftenBurstsCome) {
    Resolution resolved;
    resolved.scene.drive.repetition_hz = 250;
    const auto json = provenance_json(resolved);
    EXPECT_EQ(repetition_of(json), 250);
    EXPECT_FALSE(repetition_of({}));
    EXPECT_FALSE(repetition_of({{"scene", {{"drive", 7}}}}));
    EXPECT_FALSE(repetition_of({{"scene", {{"drive", {{"repetition_hz", "often"}}}}}}));
    EXPECT_FALSE(repetition_of({{"scene", {{"drive", {{"repetition_hz", -1}}}}}}));
}

}  // namespace
}  // namespace hertzline::test
