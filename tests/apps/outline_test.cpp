// Recordings reduced to what a picture shows.

#include "apps/commands/plot/outline.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace hertzline::app {
namespace {

TEST(Outline, KeepsSmallestAndLargestOfEachStretch) {
    std::mt19937_64 bits(20190206);
    for (const std::size_t rows : {1UL, 8192UL, 8193UL, 50'000UL, 1'000'003UL}) {
        std::vector<double> samples(3 * rows);
        std::ranges::generate(samples, [&] { return static_cast<double>(bits() >> 40) - 5e6; });
        Outline outline({0, 2}, 3);
        for (std::size_t at = 0; at < rows;) {  // in portions of any length
            const std::size_t count = std::min<std::size_t>(1 + bits() % 20'000, rows - at);
            outline.take(static_cast<std::int64_t>(1000 + at), std::span(samples).subspan(3 * at, 3 * count));
            at += count;
        }
        EXPECT_EQ(outline.first(), 1000);
        EXPECT_EQ(outline.end(), static_cast<std::int64_t>(1000 + rows));
        EXPECT_EQ(outline.width() == 1, rows <= Outline::max_stretches);
        const auto width = static_cast<std::size_t>(outline.width());
        ASSERT_EQ(outline.low(0).size(), (rows + width - 1) / width);
        ASSERT_LE(outline.low(0).size(), Outline::max_stretches);
        for (std::size_t column = 0; column < 2; ++column) {
            for (std::size_t i = 0; i < outline.low(0).size(); ++i) {
                double low = INFINITY;
                double high = -INFINITY;
                for (std::size_t row = i * width; row < std::min(rows, (i + 1) * width); ++row) {
                    low = std::min(low, samples[3 * row + 2 * column]);
                    high = std::max(high, samples[3 * row + 2 * column]);
                }
                ASSERT_EQ(outline.low(column)[i], low);
                ASSERT_EQ(outline.high(column)[i], high);
            }
        }
    }
}

TEST(Outline, HasNoNumberInAGapAndTakesItsSpectrumFromTheLongestPart) {
    Outline outline({0}, 1);
    outline.take(0, std::vector<double>(100, 1));
    outline.take(100, std::vector<double>(50, 2));  // goes on
    outline.take(1000, std::vector<double>(200, 3));
    outline.take(4'000'000'000'000'000, std::vector<double>(10, 4));  // far away
    EXPECT_EQ(outline.longest().first, 1000);
    EXPECT_EQ(outline.longest().rows, std::vector<double>(200, 3));
    EXPECT_LE(outline.low(0).size(), Outline::max_stretches);
    EXPECT_EQ(outline.low(0).front(), 1);
    EXPECT_EQ(outline.high(0).front(), 3);
    EXPECT_EQ(outline.low(0).back(), 4);
    EXPECT_EQ(std::ranges::count_if(outline.low(0), [](double low) { return !std::isnan(low); }), 2);
}

TEST(Outline, BoundsTheSamplesOfTheSpectrum) {
    Outline outline({0, 1}, 2);
    for (std::int64_t first = 0; first < 3'000'000; first += 100'000) {
        outline.take(first, std::vector<double>(200'000, 1));
    }
    EXPECT_EQ(outline.longest().rows.size(), 2 * Outline::max_spectrum_rows);
}

}  // namespace
}  // namespace hertzline::app
