#include "recordings/files/sha512.hpp"

#include <gtest/gtest.h>

namespace hertzline::test {

using namespace recordings;
namespace {

// Expected values: Python's hashlib, and for "abc" the example of FIPS 180-4.

TEST(Sha512, IsThatOfTheStandard) {
    EXPECT_EQ(sha512(""),
              "cf83e1357eefb8bdf1542850d66d8007d620e4050b5715dc83f4a921d36ce9ce"
              "47d0d13c5d85f2b0ff8318d2877eec2f63b931bd47417a81a538327af927da3e");
    EXPECT_EQ(sha512("abc"),
              "ddaf35a193617abacc417349ae20413112e6fa4e89a97ea20a9eeee64b55d39a"
              "2192992a274fc1a836ba3c23a3feebbd454d4423643ce80e2a9ac94fa54ca49f");
}

TEST(Sha512, OfTextsThatJustFillABlockOrNeedOneMore) {
    EXPECT_EQ(sha512(std::string(111, 'a')),
              "fa9121c7b32b9e01733d034cfc78cbf67f926c7ed83e82200ef8681819692176"
              "0b4beff48404df811b953828274461673c68d04e297b0eb7b2b4d60fc6b566a2");
    EXPECT_EQ(sha512(std::string(112, 'a')),
              "c01d080efd492776a1c43bd23dd99d0a2e626d481e16782e75d54c2503b5dc32"
              "bd05f0f1ba33e568b88fd2d970929b719ecbb152f58f130a407c8830604b70ca");
    EXPECT_EQ(sha512(std::string(128, 'a')),
              "b73d1929aa615934e61a871596b3f3b33359f42b8175602e89f7e06e5f658a24"
              "3667807ed300314b95cacdd579f3e33abdfbe351909519a846d465c59582f321");
    EXPECT_EQ(sha512(std::string(100'000, '\xe9')),
              "728e0b7e4d979904ab51d67b8e46bc7d9bc5c46c021be644884de5e59fd37835"
              "34c83d2944c91281d63c79b6672135a4eca9fa9f0d166d7ebaffe90630dda499");
}

}  // namespace
}  // namespace hertzline::test
