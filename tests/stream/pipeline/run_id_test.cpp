#include <set>
#include <string>

#include <gtest/gtest.h>

#include "stream/pipeline/pipeline.hpp"

namespace hertzline {

using namespace stream;
namespace {

TEST(RunId, IsAVersionFourUuid) {
    const std::string digit = "0123456789abcdef";
    const std::string pattern =
        "xxxxxxxx-xxxx-4xxx-vxxx-xxxxxxxxxxxx";  // x: any digit, v: the variant's two bits
    for (int i = 0; i < 100; ++i) {
        const std::string id = make_run_id();
        ASSERT_EQ(id.size(), pattern.size());
        for (std::size_t k = 0; k < id.size(); ++k) {
            const char p = pattern[k];
            const std::string allowed = p == 'x' ? digit : p == 'v' ? "89ab" : std::string(1, p);
            EXPECT_NE(allowed.find(id[k]), std::string::npos) << id << " at " << k;
        }
    }
}

TEST(RunId, NeverRepeats) {
    std::set<std::string> seen;
    for (int i = 0; i < 1000; ++i) {
        seen.insert(make_run_id());
    }
    EXPECT_EQ(seen.size(), 1000u);
}

}  // namespace
}  // namespace hertzline
