#include "stream/csv.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/output_file.hpp"

namespace hertzline {
namespace {
namespace fs = std::filesystem;

std::string text_of(double number) {
    std::string text;
    append_csv_number(text, number);
    return text;
}

class Csv : public testing::Test {
protected:
    fs::path file =
        fs::path(testing::TempDir()) /
        (std::string("csv_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv");

    void TearDown() override { fs::remove(file); }

    std::string contents() const {
        std::ifstream in(file);
        std::ostringstream text;
        text << in.rdbuf();
        return text.str();
    }
};

TEST(CsvColumns, WallAndFreeEndHaveOnlyTheLastSphere) {
    EXPECT_THAT(csv_columns(EndKind::wall), testing::ElementsAre("t_s", "v_last_m_per_s"));
    EXPECT_THAT(csv_columns(EndKind::free), testing::ElementsAre("t_s", "v_last_m_per_s"));
}

TEST(CsvColumns, PlateAddsItsOwnVelocityAndTheOutput) {
    EXPECT_THAT(csv_columns(EndKind::plate),
                testing::ElementsAre("t_s", "v_last_m_per_s", "v_plate_m_per_s", "v_out_m_per_s"));
}

TEST(CsvColumns, SpheresFollowNumberedFromOne) {
    EXPECT_THAT(csv_columns(EndKind::wall, 2),
                testing::ElementsAre("t_s", "v_last_m_per_s", "x1_m", "v1_m_per_s", "x2_m", "v2_m_per_s"));
}

TEST(CsvNumber, HasSeventeenSignificantDigits) {
    EXPECT_EQ(text_of(0.1), "0.10000000000000001");
    EXPECT_EQ(text_of(1.0 / 3), "0.33333333333333331");
    EXPECT_EQ(text_of(-2.5e-9), "-2.5000000000000001e-09");
    EXPECT_EQ(text_of(0), "0");
    EXPECT_EQ(text_of(10e6), "10000000");
}

TEST(CsvNumber, ReadsBackBitForBit) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> exponent(-308, 308);
    std::uniform_real_distribution<double> mantissa(-1, 1);
    for (int i = 0; i < 20'000; ++i) {
        const double number = mantissa(random) * std::pow(10.0, exponent(random));
        EXPECT_EQ(std::strtod(text_of(number).c_str(), nullptr), number);
    }
    for (const double number :
         {std::numeric_limits<double>::denorm_min(), -std::numeric_limits<double>::max()}) {
        EXPECT_EQ(std::strtod(text_of(number).c_str(), nullptr), number);
    }
}

TEST_F(Csv, IsAHeaderAndARowPerSample) {
    OutputFile out(file);
    CsvWriter csv(out, csv_columns(EndKind::plate));
    csv.row(0, std::vector{0.0, 0.0, 0.0});
    csv.row(0.5, std::vector{1.0, -2.0, 0.25});
    out.commit();
    EXPECT_EQ(contents(), "t_s,v_last_m_per_s,v_plate_m_per_s,v_out_m_per_s\n0,0,0,0\n0.5,1,-2,0.25\n");
}

TEST_F(Csv, ManyRowsArriveWholeAndInOrder) {
    constexpr int rows = 100'000;  // several buffers of the file
    OutputFile out(file);
    CsvWriter csv(out, {"t_s", "v"});
    for (int i = 0; i < rows; ++i) {
        csv.row(i, std::vector{i * 0.125});
    }
    out.commit();
    EXPECT_EQ(out.bytes(), fs::file_size(file));
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    for (int i = 0; i < rows; ++i) {
        ASSERT_TRUE(std::getline(in, line));
        ASSERT_EQ(line, text_of(i) + "," + text_of(i * 0.125));
    }
    EXPECT_FALSE(std::getline(in, line));
}

TEST_F(Csv, RowOfTheWrongWidthIsRefused) {
    OutputFile out(file);
    CsvWriter csv(out, {"t_s", "v"});
    EXPECT_THROW(csv.row(0, {}), std::invalid_argument);
    EXPECT_THROW(csv.row(0, std::vector{1.0, 2.0}), std::invalid_argument);
    EXPECT_THROW(CsvWriter(out, {}), std::invalid_argument);
}

TEST(CsvOnAFullDisk, FailsWithPathAndReasonAtTheLatestAtCommit) {
    OutputFile out("/dev/full");
    CsvWriter csv(out, {"t_s", "v"});
    csv.row(0, std::vector{1.0});
    try {
        out.commit();
        FAIL() << "a full disk went unnoticed";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("/dev/full"));
        EXPECT_THAT(error.what(), testing::HasSubstr("No space left"));
    }
}

TEST(CsvOnAFullDisk, FailsAtARowOnceTheBufferIsFull) {
    OutputFile out("/dev/full");
    CsvWriter csv(out, {"t_s", "v"});
    EXPECT_THROW(
        {
            for (int i = 0; i < 1'000'000; ++i) {
                csv.row(0.1 * i, std::vector{0.1});
            }
        },
        std::runtime_error);
}

}  // namespace
}  // namespace hertzline
