#include "recordings/file_numbers.hpp"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/allocation_count.hpp"

namespace hertzline::recordings {
namespace {

using Kind = FileNumber::Kind;

double one(const FileNumber& type, std::uint64_t bits) {
    std::array<std::byte, 8> bytes{};
    for (std::size_t i = 0; i < type.bytes; ++i) {
        const std::size_t place = type.order == std::endian::little ? i : type.bytes - 1 - i;
        bytes[i] = static_cast<std::byte>(bits >> 8 * place);
    }
    std::vector<double> numbers;
    append_numbers(type, std::span(bytes).first(type.bytes), numbers);
    return numbers.at(0);
}

TEST(FileNumbers, IntegersOfUpTo32BitsAreSharesOfTheFullScale) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        for (std::size_t bytes = 1; bytes <= 4; ++bytes) {
            const std::uint64_t middle = std::uint64_t{1} << (8 * bytes - 1);
            EXPECT_EQ(one({Kind::integer, bytes, order}, middle / 2), 0.5);
            EXPECT_EQ(one({Kind::integer, bytes, order}, middle), -1);
            EXPECT_EQ(one({Kind::natural, bytes, order}, middle), 0);
            EXPECT_EQ(one({Kind::natural, bytes, order}, 0), -1);
        }
        EXPECT_EQ(one({Kind::integer, 8, order}, ~std::uint64_t{0}), -1);
        EXPECT_EQ(one({Kind::natural, 8, order}, 300), 300);
    }
}

TEST(FileNumbers, AreAppendedWithFewAllocations) {
    if (HERTZLINE_ALLOCATIONS_ARE_COUNTED == 0) {
        GTEST_SKIP() << "the sanitizers have an allocator of their own";
    }
    const std::array<std::byte, 4> bytes{};
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        const std::size_t before = test::allocations();
        std::vector<double> numbers;
        for (int i = 0; i < 10'000; ++i) {
            append_numbers({Kind::floating, 4, order}, bytes, numbers);
        }
        EXPECT_LT(test::allocations() - before, 100);
    }
}

TEST(FileNumbers, HalfPrecisionHasSubnormalsAndNoNumbers) {
    const FileNumber half{Kind::floating, 2, std::endian::little};
    EXPECT_EQ(one(half, 0x7bff), 65504);
    EXPECT_EQ(one(half, 0x8001), -std::ldexp(1.0, -24));
    EXPECT_TRUE(std::isinf(one(half, 0x7c00)));
    EXPECT_TRUE(std::isnan(one(half, 0x7c01)));
    EXPECT_EQ(one({Kind::floating, 4, std::endian::big}, 0x3fc00000), 1.5);
}

TEST(FileNumbers, OthersAreNotKnown) {
    EXPECT_FALSE(is_known({Kind::floating, 16, std::endian::little}));
    EXPECT_FALSE(is_known({Kind::integer, 9, std::endian::little}));
    EXPECT_FALSE(is_known({Kind::natural, 0, std::endian::little}));
    EXPECT_FALSE(is_known({Kind::boolean, 4, std::endian::little}));
    EXPECT_EQ(number_type_of({Kind::integer, 3, std::endian::big}), NumberType::float32);
    EXPECT_EQ(number_type_of({Kind::integer, 4, std::endian::big}), NumberType::float64);
}

}  // namespace
}  // namespace hertzline::recordings
