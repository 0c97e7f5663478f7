#include "recordings/formats/npy.hpp"

#include <cmath>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/files/input_file.hpp"
#include "recordings/formats/npy_header.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline {

using namespace recordings;
namespace {
using testing::HasSubstr;

class Npy : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string file = folder.file("a.npy");

    template <class Number>
    void put(const NpyHeader& header, const std::vector<Number>& numbers) const {
        std::string bytes = npy_header(header);
        bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
        put(bytes);
    }
    void put(const std::string& bytes) const { std::ofstream(file, std::ios::binary) << bytes; }

    std::string refusal() const {
        return test::error_of([&] { test::read_rows(*open_npy_reader(file)); });
    }
};

TEST_F(Npy, HeaderReadsBackAndIsAlignedInBothVersions) {
    const NpyHeader plain{{{"", "<f4"}}, {3, 5}, true};
    NpyHeader longest{{{"t_s", "<f8"}}, {7}, false};
    for (int i = 0; i < 10'000; ++i) {
        longest.fields.push_back({"x" + std::to_string(i) + "_m", "<f4"});
    }
    for (const NpyHeader& header : {plain, longest, NpyHeader{{{"", "|S9"}}, {}, false}}) {
        const std::string bytes = npy_header(header);
        EXPECT_EQ(bytes.size() % 64, 0);
        EXPECT_EQ(bytes[6], bytes.size() > 0xffff ? 2 : 1);
        put(bytes);
        InputFile in(file);
        EXPECT_TRUE(read_npy_header(in) == header);
        EXPECT_EQ(in.left(), 0);
    }
}

TEST_F(Npy, HeaderTakesAsManyBytesForAnyCount) {
    const auto bytes = [](std::uint64_t rows) { return npy_header({{{"", "<f4"}}, {rows}, false}).size(); };
    EXPECT_EQ(bytes(0), bytes(~std::uint64_t{0}));
}

TEST_F(Npy, TenThousandSpheresRoundTrip) {
    const RecordingHead head = test::recording_head(NumberType::float64, 10'000);
    const RecordedRows rows = test::recorded_rows(head, 0, 20);
    const auto writer = open_npy_writer(file, head);
    writer->write(rows.first, rows.values);
    writer->commit();
    const auto reader = open_npy_reader(file);
    EXPECT_EQ(reader->head().columns, head.columns);
    EXPECT_TRUE(test::read_rows(*reader).at(0).values == rows.values);
}

TEST_F(Npy, PlainArraysOfOthersHaveChannels) {
    put<float>({{{"", "<f4"}}, {2, 3}, false}, {1, 2, 3, 4, 5, 6});
    const auto two = open_npy_reader(file);
    EXPECT_EQ(two->head().columns.at(2), (Column{"channel_3", "channel_3", ""}));
    EXPECT_EQ(two->head().numbers, NumberType::float32);
    EXPECT_EQ(two->head().sample_rate_hz, 0);
    EXPECT_THAT(test::read_rows(*two).at(0).values, testing::ElementsAre(1, 2, 3, 4, 5, 6));
    put<double>({{{"", "<f8"}}, {4}, false}, {0.5, 1, 2, 3});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values, testing::ElementsAre(0.5, 1, 2, 3));
}

TEST_F(Npy, WhatIsNotAcceptedIsNamed) {
    put<std::int32_t>({{{"", "<U1"}}, {2}, false}, {1, 2});
    EXPECT_THAT(refusal(), HasSubstr("type \"<U1\", allowed: float16"));
    put<std::uint8_t>({{{"", "<c9"}}, {1}, false}, {0, 0, 0, 0, 0, 0, 0, 0, 0});
    EXPECT_THAT(refusal(), HasSubstr("type \"<c9\", allowed: float16"));
    put<float>({{{"v", "<f4"}, {"at", "<M8[ns]"}}, {1}, false}, {1, 2, 3});
    EXPECT_THAT(refusal(), HasSubstr("type \"<M8[ns]\" in field \"at\""));
    put<float>({{{"", "<f4"}}, {1, 1, 1}, false}, {1});
    EXPECT_THAT(refusal(), HasSubstr("3 dimensions"));
    put<double>({{{"t_s", "<f8"}, {"v", "<f8"}}, {3}, false}, {0, 1, 1, 2, 1.3, 3});
    EXPECT_THAT(refusal(), HasSubstr("row 2: found the time 1.3, which is not a sample's at 1 Hz"));
    put<float>({{{"", "<f4"}}, {3}, false}, {1, 2});
    EXPECT_THAT(refusal(), HasSubstr("cut short: 3 rows of 4 bytes, 8 bytes are there"));
    put<float>({{{"", "<f4"}}, {1ULL << 62, 1ULL << 62}, false}, {1, 2});
    EXPECT_THAT(refusal(), HasSubstr("columns"));
    put<double>({{{"", "<f8"}}, {3}, false}, {1, std::nan(""), 3});
    EXPECT_THAT(refusal(), HasSubstr("row 1, column 1 is nan"));
    put<double>({{{"t_s", "<f8"}, {"v", "<f8"}}, {1}, false}, {0, 1, 2});
    EXPECT_THAT(refusal(), HasSubstr("does not begin with"));  // no description behind it
}

TEST_F(Npy, OtherTypesAndOrdersAreRead) {
    put<float>({{{"", "<f4"}}, {2, 3}, true}, {1, 4, 2, 5, 3, 6});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values, testing::ElementsAre(1, 2, 3, 4, 5, 6));
    put<std::int16_t>({{{"", "<i2"}}, {3}, false}, {16384, -32768, 1});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values,
                testing::ElementsAre(0.5, -1, 1 / 32768.0));
    std::string warning;
    open_npy_reader(file, {.sample_rate_hz = std::nullopt,
                           .warn = [&warning](const std::string& text) { warning = text; }});
    EXPECT_THAT(warning, HasSubstr("its integers are shares of the full scale"));
    put<std::uint8_t>({{{"", "|u1"}}, {2}, false}, {0, 192});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values, testing::ElementsAre(-1, 0.5));
    put<std::uint8_t>({{{"", ">i2"}}, {1}, false}, {0x40, 0});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values, testing::ElementsAre(0.5));
    put<std::uint16_t>({{{"", "<f2"}}, {4}, false}, {0x3c00, 0xc000, 0x0001, 0x3555});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values,
                testing::ElementsAre(1, -2, std::ldexp(1.0, -24), 0.333251953125));
    put<std::int64_t>({{{"", "<i8"}}, {2}, false}, {7, -7});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values, testing::ElementsAre(7, -7));
    put<std::uint8_t>({{{"", "|b1"}}, {2}, false}, {1, 0});
    EXPECT_THAT(test::read_rows(*open_npy_reader(file)).at(0).values, testing::ElementsAre(1, 0));
    put<float>({{{"", "<c8"}}, {2}, false}, {1, 2, 3, 4});
    const auto complex = open_npy_reader(file);
    EXPECT_EQ(complex->head().columns.at(1).name, "channel_1_im");
    EXPECT_THAT(test::read_rows(*complex).at(0).values, testing::ElementsAre(1, 2, 3, 4));
}

TEST_F(Npy, StructuresOfOthersHaveTheNamesOfTheirFieldsAndTheRateOfTheirTimes) {
    put<double>({{{"t_s", "<f8"}, {"v_out_m_per_s", "<f8"}, {"an other", "<f8", 2}}, {3}, false},
                {0.001, 1, 2, 3, 0.002, 4, 5, 6, 0.004, 7, 8, 9});
    const auto reader = open_npy_reader(file);
    EXPECT_EQ(reader->head().sample_rate_hz, 1000);
    EXPECT_EQ(reader->head().columns.at(0).unit, "m/s");
    EXPECT_EQ(reader->head().columns.at(2).name, "an other_2");
    const auto rows = test::read_rows(*reader);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].first, 1);
    EXPECT_THAT(rows[0].values, testing::ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_EQ(rows[1].first, 4);
    put<double>({{{"v", "<f8"}}, {2}, false}, {1, 2});
    EXPECT_EQ(open_npy_reader(file)->head().sample_rate_hz, 0);
    EXPECT_EQ(open_npy_reader(file, {.sample_rate_hz = 5, .warn = {}})->head().sample_rate_hz, 5);
}

TEST_F(Npy, UnitsOfFieldsAreKept) {
    put<double>(
        {{{"Time (ms)", "<f8"}, {"x (mm)", "<f8"}, {"x_um", "<f8", 2}, {"v (m/s)", "<c16"}}, {2}, false},
        {0, 1, 2, 3, 4, 5, 1, 6, 7, 8, 9, 0});
    const auto reader = open_npy_reader(file);
    EXPECT_EQ(reader->head().sample_rate_hz, 1000);
    EXPECT_THAT(reader->head().columns,
                testing::ElementsAre(Column{"x", "x", "mm"}, Column{"x_um_1", "x_1", "um"},
                                     Column{"x_um_2", "x_2", "um"}, Column{"v_re", "v_re", "m/s"},
                                     Column{"v_im", "v_im", "m/s"}));
}

TEST_F(Npy, TimesMayBeIntegers) {
    put<std::int32_t>({{{"time_us", "<i4"}, {"in", "<f4"}}, {3}, false}, {5, 0, 7, 0, 9, 0});
    const auto reader = open_npy_reader(file);
    EXPECT_EQ(reader->head().sample_rate_hz, 5e5);
    EXPECT_EQ(reader->head().columns.at(0).name, "in");
    EXPECT_THAT(test::read_rows(*reader).at(0).values, testing::SizeIs(3));
    put<float>({{{"in", "<f4"}, {"out", "<f4"}}, {2}, false}, {1, 2, 3, 4});
    EXPECT_EQ(open_npy_reader(file)->head().sample_rate_hz, 0) << "in is no time";
    EXPECT_EQ(open_npy_reader(file)->head().columns.size(), 2U);
}

TEST_F(Npy, MoreChannelsThanSamplesAreWarnedOf) {
    put<float>({{{"", "<f4"}}, {2, 3}, false}, {1, 2, 3, 4, 5, 6});
    std::string warning;
    open_npy_reader(file, {.sample_rate_hz = {}, .warn = [&](const std::string& text) { warning = text; }});
    EXPECT_THAT(warning, HasSubstr("found 3 channels of 2 samples"));
    put<float>({{{"", "<f4"}}, {1}, false}, {1, 2});
    open_npy_reader(file, {.sample_rate_hz = {}, .warn = [&](const std::string& text) { warning = text; }});
    EXPECT_THAT(warning, HasSubstr("4 bytes behind the array are left out"));
}

TEST_F(Npy, HostileHeadersAreRefused) {
    const auto header = [&](const std::string& text) {
        put("\x93NUMPY\x01" + std::string(1, '\0') + static_cast<char>(text.size()) + std::string(1, '\0') +
            text);
        return refusal();
    };
    EXPECT_EQ(header("{'descr': '<f4', 'fortran_order': False, 'shape': (0,)}"), "");
    EXPECT_THAT(header("{'descr': '<f4', 'fortran_order': False, 'shape': (0,)"), HasSubstr("expected }"));
    EXPECT_THAT(header("{'descr': '<f4', 'shape': (0,)}"), HasSubstr("expected descr, fortran_order"));
    EXPECT_THAT(header("{'descr': __import__('os')}"), HasSubstr("expected '"));
    EXPECT_THAT(header("{'descr': '<f4', 'fortran_order': False, 'shape': (-1,)}"), HasSubstr("a length"));
    EXPECT_THAT(header("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,)}"),
                HasSubstr("a length"));
    put("\x93NUMPY\x02" + std::string(1, '\0') + "\xff\xff\xff\xff");
    EXPECT_THAT(refusal(), HasSubstr("4294967295 bytes"));
}

TEST_F(Npy, TimeThatIsNoSamplesIsDamage) {
    const RecordingHead head = test::recording_head(NumberType::float64);
    const auto writer = open_npy_writer(file, head);
    writer->write(0, std::vector<double>{1, 2, 3, 4});
    writer->commit();
    const std::size_t second_row =
        npy_header({{{"t_s", "<f8"}, {"v_last_m_per_s", "<f8"}, {"v_out_m_per_s", "<f8"}}, {2}, false})
            .size() +
        24;
    for (const double t : {1.00001e-7, 0.0, -1e-7, 1e300, std::nan("")}) {
        std::fstream change(file, std::ios::binary | std::ios::in | std::ios::out);
        change.seekp(static_cast<std::streamoff>(second_row));
        change.write(reinterpret_cast<const char*>(&t), sizeof t);
        change.close();
        EXPECT_THAT(refusal(), HasSubstr("damaged: row 1 has the time")) << t;
    }
}

}  // namespace
}  // namespace hertzline
