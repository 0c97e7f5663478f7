#include "recordings/float32.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

namespace hertzline::test {

using namespace recordings;
namespace {

TEST(ToFloat32, RoundsToTheNearestFloat) {
    const std::vector<double> samples{0.0, -0.0, 0.1, -1.5, 1e-40, 1e-60, std::numeric_limits<float>::max()};
    std::vector<float> out(samples.size());
    EXPECT_EQ(to_float32(samples, out), 0u);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(out[i]),
                  std::bit_cast<std::uint32_t>(static_cast<float>(samples[i])));
    }
}

TEST(ToFloat32, CountsWhatNoFloatCanHoldAndWritesNoPlausibleNumber) {
    const double beyond = std::nextafter(static_cast<double>(std::numeric_limits<float>::max()), HUGE_VAL);
    const std::vector<double> samples{1.0, 1e39, -beyond, HUGE_VAL, -HUGE_VAL, std::nan(""), 2.0};
    std::vector<float> out(samples.size());
    EXPECT_EQ(to_float32(samples, out), 5u);
    EXPECT_EQ(out.front(), 1.0F);
    EXPECT_EQ(out.back(), 2.0F);
    for (std::size_t i = 1; i + 1 < out.size(); ++i) {
        EXPECT_TRUE(std::isnan(out[i])) << i;
    }
}

TEST(Samples, AreLittleEndianOnTheWire) {
    const std::vector<float> samples{1.0F, -2.5F};
    const auto bytes = wire_bytes(samples);
    const std::vector<int> expected{0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x20, 0xc0};
    ASSERT_EQ(bytes.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(std::to_integer<int>(bytes[i]), expected[i]) << i;
    }
}

TEST(Samples, AreReadFromAnyAddress) {
    const std::vector<float> samples{1.0F, -2.5F, 3e-5F};
    std::vector<std::byte> shifted(1 + 12);
    std::memcpy(shifted.data() + 1, samples.data(), 12);
    std::vector<float> read;
    EXPECT_TRUE(decode_samples(std::span(shifted).subspan(1), read));
    EXPECT_EQ(read, samples);
    EXPECT_FALSE(decode_samples(shifted, read));
    EXPECT_EQ(read, samples);
    EXPECT_TRUE(decode_samples({}, read));
    EXPECT_TRUE(read.empty());
}

}  // namespace
}  // namespace hertzline::test
