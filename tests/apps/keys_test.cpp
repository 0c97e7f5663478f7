// hertzline keys: the files that it writes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/wire/security/certificate.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

using namespace stream;

namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Keys, AreWrittenOnceAndReadBack) {
    const TemporaryFolder folder;
    const Outcome made = hertzline({"keys", folder.file("alice"), "--json"});
    ASSERT_EQ(made.status, 0) << made.err;
    const json summary = made.json();
    EXPECT_EQ(summary["public_file"], folder.file("alice.key"));
    EXPECT_EQ(summary["secret_file"], folder.file("alice.key_secret"));
    const auto pair = read_key_pair(folder.file("alice.key_secret"));
    ASSERT_TRUE(pair) << pair.error();
    EXPECT_EQ(summary["public_key"], z85(pair->public_key));
    EXPECT_EQ(made.out.find(z85(pair->secret_key)), std::string::npos);

    for (const char* name : {"", ".", "..", "folder/", "folder/."}) {
        EXPECT_EQ(hertzline({"keys", name}).status, 2) << name;
    }
    const Outcome again = hertzline({"keys", folder.file("alice")});
    EXPECT_EQ(again.status, 1);
    EXPECT_THAT(again.err, HasSubstr("alice.key_secret: File exists"));
    EXPECT_EQ(read_key_pair(folder.file("alice.key_secret"))->secret_key, pair->secret_key);
}

}  // namespace

}  // namespace hertzline::test
