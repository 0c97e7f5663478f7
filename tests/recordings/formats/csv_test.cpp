#include "recordings/formats/csv/csv.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/error_of.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace recordings;
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string text_of(double number) {
    std::string text;
    append_csv_number(text, number);
    return text;
}

TEST(CsvNumber, IsTheShortestThatReadsBackTheSame) {
    EXPECT_EQ(text_of(0.1), "0.1");
    EXPECT_EQ(text_of(1.0 / 3), "0.3333333333333333");
    EXPECT_EQ(text_of(-2.5e-9), "-2.5e-09");
    EXPECT_EQ(text_of(0), "0");
    EXPECT_EQ(text_of(10e6), "1e+07");
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

TEST(Csv, IsALineOfNamesAndALineForEachSample) {
    const TemporaryFolder folder;
    const auto writer =
        open_csv_writer(folder.file("a.csv"), recording_head({"v_last_m_per_s", "v_out_m_per_s"}, 2));
    writer->write(0, std::vector{0.0, 0.0, 1.0, -2.0});
    writer->write(5, std::vector{0.25, 0.5});
    EXPECT_FALSE(fs::exists(folder.file("a.csv")));
    writer->commit();
    EXPECT_EQ(contents(folder.file("a.csv")),
              "t_s,v_last_m_per_s,v_out_m_per_s\n0,0,0\n0.5,1,-2\n2.5,0.25,0.5\n");
}

TEST(Csv, MetadataBesideItSayWhatTheColumnsAreAndWhereTheyComeFrom) {
    const TemporaryFolder folder;
    RecordingHead head = recording_head({"v_last_m_per_s", "x1_m"}, 2);
    head.provenance = {{"version", "1.2.3"}};
    open_csv_writer(folder.file("a.csv"), head)->commit();
    const json metadata = json::parse(contents(folder.file("a.csv-metadata.json")));
    EXPECT_EQ(metadata["@context"], "http://www.w3.org/ns/csvw");
    EXPECT_EQ(metadata["url"], "a.csv");
    EXPECT_EQ(Json::parse(csv_metadata("b/m%\u00fc#x?y:z-1.csv",
                                       std::vector{CsvColumn{{"t_s", "", "s"}, "double"}}, {}))["url"],
              "m%25%C3%BC%23x%3Fy%3Az-1.csv");
    EXPECT_EQ(metadata["urn:hertzline:provenance"]["version"], "1.2.3");
    const json& columns = metadata["tableSchema"]["columns"];
    ASSERT_EQ(columns.size(), 3U);
    EXPECT_EQ(columns[0]["name"], "t_s");
    EXPECT_EQ(columns[1]["schema:unitText"], "m/s");
    EXPECT_EQ(columns[2]["name"], "x1_m");
    EXPECT_EQ(columns[2]["schema:unitText"], "m");
}

TEST(Csv, ADeviceGetsNoMetadata) {
    open_csv_writer("/dev/null", recording_head({"v"}, 1))->commit();
    EXPECT_FALSE(fs::exists("/dev/null-metadata.json"));
}

TEST(Csv, WithoutCommitNothingIsLeftAndWhatWasThereStays) {
    const TemporaryFolder folder;
    open_csv_writer(folder.file("a.csv"), recording_head({"v"}, 1))->commit();
    const std::string metadata = contents(folder.file("a.csv-metadata.json"));
    open_csv_writer(folder.file("a.csv"), recording_head({"w"}, 1))->write(0, std::vector{1.0});
    EXPECT_EQ(contents(folder.file("a.csv")), "t_s,v\n");
    EXPECT_EQ(contents(folder.file("a.csv-metadata.json")), metadata);
}

TEST(Csv, AFullDiskIsToldOfWithPathAndReason) {
    const auto writer = open_csv_writer("/dev/full", recording_head({"v"}, 1));
    writer->write(0, std::vector{1.0});
    EXPECT_THAT(error_of([&] { writer->commit(); }),
                testing::AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
    const auto large = open_csv_writer("/dev/full", recording_head({"v"}, 1));
    EXPECT_THAT(error_of([&] { large->write(0, std::vector<double>(100'000, 1.0 / 3)); }),
                HasSubstr("No space left"));
}

TEST(Csv, MetadataThatCannotBeWrittenAreToldOfBeforeAnythingIsReplaced) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"), "old");
    fs::create_directories(folder.file("a.csv-metadata.json/full"));
    EXPECT_THAT(error_of([&] { open_csv_writer(folder.file("a.csv"), recording_head({"v"}, 1)); }),
                HasSubstr("a.csv-metadata.json"));
    fs::remove_all(folder.file("a.csv-metadata.json"));
    const auto writer = open_csv_writer(folder.file("a.csv"), recording_head({"v"}, 1));
    writer->write(0, std::vector{1.0});
    fs::create_directories(folder.file("a.csv-metadata.json/full"));  // meanwhile
    EXPECT_NE(error_of([&] { writer->commit(); }), "");
    EXPECT_EQ(contents(folder.file("a.csv")), "old");
    EXPECT_EQ(writer->kept().rows, 1);
    EXPECT_EQ(contents(writer->kept().file), "t_s,v\n0,1\n");
}

/// Runs in a process of its own, because the limit on the size of files cannot be raised again.
TEST(Csv, AFullDiskLeavesWholeLines) {
    const TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit small{2'000'001, 2'000'001};
        setrlimit(RLIMIT_FSIZE, &small);
        const auto writer = open_csv_writer(folder.file("a.csv"), recording_head({"v"}, 1));
        std::string error;
        for (std::int64_t first = 0; first < 1'000'000 && error.empty(); first += 100) {
            error = error_of([&] { writer->write(first, std::vector<double>(100, 0.5)); });
        }
        const KeptRows& kept = writer->kept();
        const std::string text = contents(kept.file);
        const bool whole = text.ends_with(",0.5\n") && text.size() > 1'999'980 &&
                           std::count(text.begin(), text.end(), '\n') == kept.rows + 1;
        _exit(error.find("File too large") != std::string::npos && whole ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}

TEST(CsvReader, TakesTheRateFromTheTimesWhenThereAreNoMetadata) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"),
               "t_s,v_out_m_per_s,other\n3e-07,1,2\n3.9999999999999998e-07,3,4\r\n9e-07,5,6\n");
    const auto reader = open_csv_reader(folder.file("a.csv"));
    EXPECT_EQ(reader->head().sample_rate_hz, 10e6);
    EXPECT_EQ(reader->head().columns[0].unit, "m/s");
    EXPECT_EQ(reader->head().columns[1].quantity, "other");
    RecordedRows rows;
    ASSERT_TRUE(reader->read(rows, 100));
    EXPECT_EQ(rows.first, 3);
    EXPECT_THAT(rows.values, ElementsAre(1, 2, 3, 4));
    ASSERT_TRUE(reader->read(rows, 100));
    EXPECT_EQ(rows.first, 9);
    EXPECT_FALSE(reader->read(rows, 100));
}

TEST(CsvReader, AColumnWithoutTimesNeedsItsRate) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.csv");
    const auto read = [&](const std::string& text) {
        write_text(file, text);
        const auto reader = open_csv_reader(file, {.sample_rate_hz = 2e6, .warn = {}});
        EXPECT_EQ(reader->head().sample_rate_hz, 2e6);
        RecordedRows rows;
        EXPECT_TRUE(reader->read(rows, 100));
        EXPECT_EQ(rows.first, 0);
        return std::pair(reader->head().columns.front(), rows.values);
    };
    const std::vector<double> numbers{0, -1.5, 2e-6};
    EXPECT_EQ(read("0\n-1.5\n2e-6\n"), std::pair(Column({"channel_1", "channel_1", ""}), numbers));
    EXPECT_EQ(read("# of a vibrometer\r\n\r\n0\r\n-1.5\r\n2e-6\r\n\r\n").second, numbers);
    EXPECT_EQ(read("x_um\n0\n-1.5\n2e-6\n").first, column_named("x_um"));
    EXPECT_EQ(read("Channel 1 (mm/s)\n0\n-1.5\n2e-6\n").first.unit, "mm/s");
    EXPECT_EQ(read("# v_m_per_s\n0\n-1.5\n2e-6\n").first, column_named("v_m_per_s"));
    EXPECT_EQ(read("% 2 MHz\n% Channel 1 (V)\r\n\n# of a vibrometer, (1 of 2)\n0\n-1.5\n2e-6\n").first.unit,
              "V");
    const auto fault = [&](const std::string& text) {
        write_text(file, text);
        return error_of([&] { read_rows(*open_csv_reader(file, {.sample_rate_hz = 2e6, .warn = {}})); });
    };
    EXPECT_THAT(fault("when,v\n0,1\n1,2\n"), HasSubstr("allowed: t_s")) << "a column might be the time";
    EXPECT_THAT(fault("0,1\n1,2\n"), HasSubstr("allowed: t_s")) << "two columns, or a decimal comma?";
    EXPECT_THAT(fault("0\n0,5\n"), HasSubstr("a.csv:2: expected a number, with a decimal point"));
    EXPECT_THAT(fault("v\n0\nnone\n"), HasSubstr("a.csv:3: expected a number"));
    EXPECT_THAT(fault("v\n0\nnan\n"), HasSubstr("a.csv:3: found a number that is not finite"));
    EXPECT_THAT(fault("some words\nand more\n"), HasSubstr("or give the rate of a file of one column"));
}

TEST(CsvReader, TheRateIsRightHoweverLateTheRecordingBegins) {
    const TemporaryFolder folder;
    for (const double rate : {10e6, 1e6, 44'100.0, 12'345.678, 2.5e6, 1 / 3.0}) {
        for (const double begin_s : {0.0, 10.0, 100.0, 3600.0, 86'400.0}) {
            const auto first = static_cast<std::int64_t>(begin_s * rate);
            const std::string file = folder.file("a.csv");
            const auto writer = open_csv_writer(file, recording_head({"v"}, rate));
            writer->write(first, std::vector<double>(3000, 0.5));
            writer->write(first + 5000, std::vector<double>(10, 0.5));
            writer->commit();
            fs::remove(csv_metadata_path(file));
            const auto rows = read_rows(*open_csv_reader(file));
            ASSERT_EQ(rows.size(), 2U) << rate << " Hz from " << begin_s << " s on";
            EXPECT_EQ(rows[0].first, first) << rate << " Hz from " << begin_s << " s on";
            EXPECT_EQ(rows[1].first, first + 5000) << rate << " Hz from " << begin_s << " s on";
        }
    }
}

TEST(CsvReader, ALineWithoutEndIsRefused) {
    const TemporaryFolder folder;
    EXPECT_THAT(error_of([&] { open_csv_reader("/dev/zero"); }), HasSubstr("/dev/zero:1: found a byte 0"));
    write_text(folder.file("a.csv"), "t_s,v\n0,1\n");
    fs::resize_file(folder.file("a.csv"), std::uintmax_t{1} << 40);  // with a hole in it
    EXPECT_THAT(error_of([&] { read_rows(*open_csv_reader(folder.file("a.csv"))); }),
                HasSubstr("a.csv:3: found a byte 0"));
}

TEST(CsvReader, ALineBeyondHalfAGigabyteIsRefused) {
    const TemporaryFolder folder;
    std::ofstream file(folder.file("a.csv"));
    file << "t_s,v\n";
    const std::string mebibyte(1 << 20, '1');
    for (int i = 0; i < 512; ++i) {
        file << mebibyte;
    }
    file << '\n';
    file.close();
    EXPECT_THAT(error_of([&] { read_rows(*open_csv_reader(folder.file("a.csv"))); }),
                HasSubstr("a.csv:2: the line is too long"));
}

TEST(CsvReader, APipeNeedsMetadata) {
    const TemporaryFolder folder;
    const std::string pipe = folder.file("a.csv");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::signal(SIGPIPE, SIG_IGN);  // the reader may be gone before the writer writes
    std::jthread writer([&] { write_text(pipe, "t_s,v\n0,1\n1,2\n"); });
    EXPECT_THAT(error_of([&] { open_csv_reader(pipe); }), HasSubstr("no metadata"));
    writer.join();
    std::jthread another([&] { write_text(pipe, "t_s,v\n0,1\n1,2\n"); });
    EXPECT_EQ(read_rows(*open_csv_reader(pipe, {.sample_rate_hz = 1, .warn = {}})).at(0).values.size(), 2U);
}

TEST(CsvReader, ALineMayBeLongerThanTheBuffer) {
    const TemporaryFolder folder;
    for (const std::size_t columns : {10, 6000, 9361, 9362, 9363, 20'000}) {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < columns; ++i) {
            names.push_back(fmt::format("c{:05}", i));
        }
        const RecordingHead head = recording_head(names, 10);
        const std::vector<RecordedRows> rows{recorded_rows(head, 0, 3)};
        const auto writer = open_csv_writer(folder.file("a.csv"), head);
        write_rows(*writer, rows);
        writer->commit();
        EXPECT_EQ(read_rows(*open_csv_reader(folder.file("a.csv"))).at(0).values, rows[0].values);
    }
}

TEST(CsvReader, NamesTheLineThatIsWrong) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.csv");
    const auto fault = [&](const std::string& text) {
        write_text(file, text);
        return error_of([&] { read_rows(*open_csv_reader(file)); });
    };
    EXPECT_THAT(fault(""), HasSubstr("a.csv:1"));
    EXPECT_THAT(fault("v\n0\n1\n"), HasSubstr("allowed: t_s"));
    EXPECT_THAT(fault("when,v\n"), HasSubstr("a.csv:1: found the column names \"when,v\", allowed: t_s"));
    EXPECT_THAT(fault("Model;X\n0,0;1,5\n"), HasSubstr("write such a line above the numbers"));
    EXPECT_THAT(fault("Time (h),v\n0,1\n"), HasSubstr("allowed: t_s"));
    EXPECT_THAT(fault("time,v\nh,V\n0,1\n"),
                HasSubstr("a.csv:2: found the unit \"h\" of the times, allowed: s, ms"));
    EXPECT_THAT(fault("t_s;v\n0,5;1,5\n1.5;2,5\n"), HasSubstr("a.csv:3: found a decimal comma beside"));
    EXPECT_THAT(fault("t_s;v\n0;1.234,5\n1;1\n"), HasSubstr("a.csv:2: found a decimal comma beside"));
    EXPECT_THAT(fault("t_s,v\n0,1\n1,nan\n"), HasSubstr("a.csv:3: found a number that is not finite"));
    EXPECT_THAT(fault("\xff\xfet\0_\0s\0"), HasSubstr("UTF-16"));
    EXPECT_THAT(fault("t_s\n0\n"), HasSubstr("a.csv:1"));
    EXPECT_THAT(fault("t_s,v\n0,1\n1,\n"), HasSubstr("a.csv:3: expected 2 numbers"));
    EXPECT_THAT(fault("t_s,v\n0,1\n1,2,3\n"), HasSubstr("a.csv:3"));
    EXPECT_THAT(fault("t_s,v\n0,1\n1\n"), HasSubstr("a.csv:3"));
    EXPECT_THAT(fault("t_s,v\n0,1\n0,1\n"), HasSubstr("does not increase"));
    EXPECT_THAT(fault("t_s,v\n0,1\n1,1\n2,1\n1,1\n"), HasSubstr("a.csv:5: the time does not increase"));
    EXPECT_THAT(fault("t_s,v\n0,1\n1,1\n2.5,1\n"), HasSubstr("a.csv:4: found the time 2.5"));
    EXPECT_THAT(fault("t_s,v\n0,1\n0.0103,1\n0.0199,1\n0.0302,1\n"),
                HasSubstr("a.csv:4: found the time 0.0199, which is not a sample's at"));
    EXPECT_EQ(fault("t_s,v\n-1,1\n0,1\n"), "");
    EXPECT_THAT(fault("t_s,v\nnan,1\n0,1\n"), HasSubstr("a.csv"));
    EXPECT_THAT(fault("t_s,v\n0,inf\n1,1\n"), HasSubstr("a.csv"));
    EXPECT_EQ(fault("t_s,v\n0,1\n"), "");
    EXPECT_EQ(fault("t_s,v\n"), "");
    EXPECT_THAT(error_of([&] { open_csv_reader(folder.file("none.csv")); }), HasSubstr("none.csv"));
}

struct Read {
    RecordingHead head;
    std::vector<RecordedRows> rows;
    std::vector<std::string> warnings;
};

Read read_csv(const std::string& text, std::optional<double> rate = std::nullopt) {
    const TemporaryFolder folder;
    write_text(folder.file("a.csv"), text);
    Read read;
    const auto reader = open_csv_reader(folder.file("a.csv"),
                                        {.sample_rate_hz = rate, .warn = [&](const std::string& warning) {
                                             read.warnings.push_back(warning);
                                         }});
    read.head = reader->head();
    read.rows = read_rows(*reader);
    return read;
}

class CsvDialect : public testing::TestWithParam<const char*> {};

TEST_P(CsvDialect, IsRead) {
    const Read read = read_csv(GetParam());
    ASSERT_EQ(read.rows.size(), 1U);
    EXPECT_THAT(read.rows[0].values, ElementsAre(0.5, -1.5, 2));
    EXPECT_EQ(read.head.sample_rate_hz, 1000);
    EXPECT_THAT(read.warnings, testing::IsEmpty());
}

TEST(Csv, TellsThatAFileOfAnOscilloscopeBeganBeforeItsTrigger) {
    const Read read = read_csv("x-axis,1\nsecond,Volt\n-5e-3,0.5\n-4e-3,-1.5\n-3e-3,2\n");
    ASSERT_EQ(read.rows.size(), 1U);
    EXPECT_EQ(read.rows[0].first, 0);
    EXPECT_THAT(read.warnings,
                ElementsAre(testing::EndsWith("its times begin at -0.005 s, which becomes 0")));
}

INSTANTIATE_TEST_SUITE_P(
    OfEachKind, CsvDialect,
    testing::Values(
        "t_s,v\n0,0.5\n1e-3,-1.5\n2e-3,2\n", "\xef\xbb\xbft_s,v\n0,0.5\n1e-3,-1.5\n2e-3,2\n",
        "t_s,v\r0,0.5\r1e-3,-1.5\r2e-3,2\r", "t_s,v\r\n0,0.5\r\n1e-3,-1.5\r\n2e-3,2\r\n\r\n",
        "t_s,v\n0,+0.5\n+1e-3,-1.5\n\n2e-3,+2\n \n,\n", "t_s;v\n0;0,5\n0,001;-1,5\n0,002;2\n",
        "t_s;v\n0;,5\n0,001;-1,5\n0,002;2\n", "t_s\tv\n0\t0,5\n0,001\t-1,5\n0,002\t2\n",
        "\"t_s\",\"v\"\n\"0\",\"0,5\"\n\"0,001\",\"-1,5\"\n\"0,002\",\"2\"\n",
        "sep=;\nt_s;v\n0;0.5\n1e-3;-1.5\n2e-3;2\n", "# t_s,v\n0,0.5\n1e-3,-1.5\n2e-3,2\n",
        "% made by hand\n\nModel,X\nTIME,CH1\n0,0.5\n1e-3,-1.5\n2e-3,2\n",
        "Time,A\n(ms),(V)\n\n0,0.5\n1,-1.5\n2,2\n", "in s,C1 in V\n0,0.5\n1e-3,-1.5\n2e-3,2\n",
        "Time (\xc2\xb5s),A\n0,0.5\n1000,-1.5\n2000,2\n", ",t_s,v\n0,0,0.5\n1,1e-3,-1.5\n2,2e-3,2\n",
        "t_s,v,\n0,0.5,\n1e-3,-1.5,\n2e-3,2,\n", " t_s , v\n 0 , 0.5\n 1e-3 ,\t-1.5\n2e-3, 2 \n",
        "Date,1.4.2024\nTime,12:30:45\nSample Interval,1e-3\nTime (s),A\n0,0.5\n1e-3,-1.5\n2e-3,2\n",
        "Time,A\n(\xb5s),(V)\n0,0.5\n1000,-1.5\n2000,2\n",
        "x-axis,1\nsecond,Volt\n0,0.5\n1e-3,-1.5\n2e-3,2\n", "Time (ns),A\n0,0.5\n1e6,-1.5\n2e6,2\n",
        "Temps (ps),A\n0,0.5\n1e9,-1.5\n2e9,2\n", "tiempo (sec),A\n0,0.5\n1e-3,-1.5\n2e-3,2\n",
        "Tempo (seconds),A\n0,0.5\n1e-3,-1.5\n2e-3,2\n", "__time,A\n0,0.5\n1e-3,-1.5\n2e-3,2\n"));

TEST(CsvReader, TakesNamesAndUnitsAndTellsColumnsApart) {
    const Read read = read_csv("Time (s),Channel 1 (V),Channel 1 (V),v_out_m_per_s,,t_s\n0,1,2,3,4,5\n");
    std::vector<std::string> names;
    for (const Column& column : read.head.columns) {
        names.push_back(column.name);
    }
    EXPECT_THAT(names, ElementsAre("Channel 1", "Channel 1_2", "v_out_m_per_s", "channel_4", "t_s_2"));
    EXPECT_EQ(read.head.columns[0].unit, "V");
    EXPECT_EQ(read.head.columns[2].quantity, "v_out");
}

/// Times of rows as a program prints them that rounds.
std::string rounded_times(double rate, int decimals, int rows, double from_s = 0) {
    std::string text = "t_s,v\n";
    for (int i = 0; i < rows; ++i) {
        text += fmt::format("{:.{}f},{}\n", from_s + i / rate, decimals, i);
    }
    return text;
}

TEST(CsvReader, TheRateIsThePlainestThatRoundedTimesKeepTo) {
    for (const double rate : {48'000.0, 44'100.0, 96'000.0, 22'050.0, 250'000.0, 1 / 0.0003}) {
        const Read read = read_csv(rounded_times(rate, 6, 10'000));
        EXPECT_DOUBLE_EQ(read.head.sample_rate_hz, rate);
        ASSERT_EQ(read.rows.size(), 1U) << rate;
        EXPECT_EQ(read.rows[0].values.size(), 10'000U);
        EXPECT_EQ(read.rows[0].first, 0);
    }
}

TEST(CsvReader, AGivenRateIsTheRateWhereTheTimesKeepToIt) {
    const Read fine = read_csv(rounded_times(48'001, 6, 10'000), 48'001);
    EXPECT_EQ(fine.head.sample_rate_hz, 48'001);
    EXPECT_EQ(fine.rows.at(0).values.size(), 10'000U);
    const Read coarser_than_samples = read_csv(rounded_times(2e6, 6, 1000), 2e6);
    EXPECT_EQ(coarser_than_samples.rows.at(0).values.size(), 1000U);
    EXPECT_THAT(error_of([] { read_csv(rounded_times(2e6, 6, 1000)); }),
                HasSubstr("the time does not increase"));
    const Read another = read_csv(rounded_times(1000, 3, 100), 2000);
    EXPECT_EQ(another.head.sample_rate_hz, 1000) << "the samples are those of the times";
    EXPECT_EQ(another.rows.at(0).values.size(), 100U);
    EXPECT_EQ(read_csv("t_s,v\n0,1\n", 50).head.sample_rate_hz, 50);
}

TEST(CsvReader, AGapIsSeenInTimesOfFewDigits) {
    const Read read = read_csv("t_s,v\n0,1\n1,2\n3,3\n4,4\n");
    EXPECT_EQ(read.head.sample_rate_hz, 1);
    ASSERT_EQ(read.rows.size(), 2U);
    EXPECT_EQ(read.rows[1].first, 3);
}

TEST(CsvReader, SamplesAreCountedFromTheFirstRowWhereItsTimeIsBeforeZeroOrBetweenTwo) {
    for (const double from_s : {-0.01, 0.01003}) {
        const Read read = read_csv(rounded_times(10'000, 6, 100, from_s));
        EXPECT_EQ(read.head.sample_rate_hz, 10'000);
        EXPECT_EQ(read.rows.at(0).first, 0);
        EXPECT_EQ(read.rows.at(0).values.size(), 100U);
    }
    EXPECT_EQ(read_csv(rounded_times(10'000, 6, 100, 0.01)).rows.at(0).first, 100);
}

TEST(CsvReader, TimesOfADateAreCountedFromTheFirstRow) {
    const Read read = read_csv(rounded_times(1e6, 6, 100, 1'700'000'000));
    EXPECT_EQ(read.head.sample_rate_hz, 1e6);
    EXPECT_EQ(read.rows.at(0).first, 0);
    EXPECT_EQ(read.rows.at(0).values.size(), 100U);
    EXPECT_EQ(read_csv(rounded_times(1000, 6, 100, 1'700'000'000)).rows.at(0).first, 1'700'000'000'000);
}

TEST(CsvReader, AColumnThatIsNoTimeIsNotTakenForOne) {
    for (const char* text : {"in,out\n0.1,0.2\n0.2,0.3\n", "in (V),out (V)\n0.1,0.2\n0.2,0.3\n"}) {
        EXPECT_THAT(error_of([&] { read_csv(text); }), HasSubstr("found the column names \"in"));
    }
    EXPECT_THAT(error_of([] { read_csv("time,v\n2024-01-01 00:00:00,1\n2024-01-01 00:00:01,2\n"); }),
                HasSubstr("a.csv:2: expected 2 numbers"));
}

TEST(CsvReader, ASingleRowTellsNoRate) {
    const Read read = read_csv("t_s,v\n300,1\n");
    EXPECT_EQ(read.head.sample_rate_hz, 0);
    EXPECT_THAT(read.rows.at(0).values, ElementsAre(1));
}

TEST(CsvReader, ALastLineWithoutItsEndIsLeftOutWithAWarning) {
    const Read read = read_csv("t_s,v\n0,1\n1,2\n2,3.25");
    EXPECT_THAT(read.rows.at(0).values, ElementsAre(1, 2));
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_THAT(read.warnings[0], HasSubstr("a.csv:4: left out"));
    const TemporaryFolder folder;
    const RecordingHead head = recording_head({"v"}, 1000);
    const auto writer = open_csv_writer(folder.file("a.csv"), head);
    writer->write(0, std::vector<double>(10, 1.0 / 3));
    writer->commit();
    fs::resize_file(folder.file("a.csv"), fs::file_size(folder.file("a.csv")) - 10);
    EXPECT_THAT(read_rows(*open_csv_reader(folder.file("a.csv"))).at(0).values,
                testing::AllOf(testing::SizeIs(9), testing::Each(1.0 / 3)));
}

TEST(CsvReader, AnEmptyLineBetweenSamplesWithoutTimesIsALostSample) {
    EXPECT_THAT(read_csv("v\n\n1\n# a remark\n2\n3\n\n\n", 1000).rows.at(0).values, ElementsAre(1, 2, 3));
    EXPECT_THAT(error_of([] { read_csv("v\n1\n2\n\n3\n", 1000); }),
                HasSubstr("a.csv:4: found no number between two samples"));
    EXPECT_THAT(error_of([] { read_csv("v\n1\n,\n3\n", 1000); }), HasSubstr("a.csv:3: found no number"));
}

TEST(CsvReader, MetadataOfAnotherTableAreLeftOutWithAWarning) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.csv");
    const auto writer = open_csv_writer(file, recording_head({"v"}, 1000));
    writer->write(0, std::vector<double>(10, 0.5));
    writer->commit();
    const std::string own = contents(csv_metadata_path(file));
    const auto warnings_at = [&](double rate_hz) {
        std::vector<std::string> warnings;
        ReadOptions options;
        options.warn = [&](const std::string& text) { warnings.push_back(text); };
        const auto reader = open_csv_reader(file, options);
        EXPECT_EQ(reader->head().provenance.is_null(), !warnings.empty());
        EXPECT_NEAR(reader->head().sample_rate_hz, rate_hz, 1e-9 * rate_hz);
        return warnings;
    };
    const auto warnings_with = [&](const std::string& table, const std::string& metadata) {
        write_text(file, table);
        write_text(csv_metadata_path(file), metadata);
        return warnings_at(table.find("\n0.001,") == std::string::npos ? 1e6 : 1000);
    };
    const std::string same = "t_s,v\n0,1\n0.001,1\n0.002,1\n";
    const std::string faster = "t_s,v\n0,1\n1e-6,1\n2e-6,1\n";
    EXPECT_THAT(warnings_with(same, own), IsEmpty());
    EXPECT_THAT(warnings_with("t_s,v\n0,1\n0.001,1\n0.007,1\n", own), IsEmpty()) << "lost samples";
    EXPECT_THAT(warnings_with(faster, own),
                ElementsAre(HasSubstr(
                    "a.csv-metadata.json: left out, because the times are not those of its 1000 Hz")));
    EXPECT_THAT(warnings_with("t_s,u\n0,1\n0.001,1\n", own), ElementsAre(HasSubstr("other columns")));
    for (const double rate : {500, 700, 900, 990, 1001, 1100, 1300, 1400, 2000}) {
        const auto other = open_csv_writer(file, recording_head({"v"}, rate));
        other->write(0, std::vector<double>(1200, 0.5));
        other->commit();
        write_text(csv_metadata_path(file), own);
        EXPECT_THAT(warnings_at(rate), ElementsAre(HasSubstr("not those of its 1000 Hz"))) << rate;
    }
    EXPECT_THAT(warnings_with("t_s,v,u\n0,1,1\n0.001,1,1\n", own), ElementsAre(HasSubstr("other columns")));
    for (
        const char* text :
        {"[]", "{}", "7", R"({"urn:hertzline:sample_rate_hz": "x"})",
         R"({"urn:hertzline:sample_rate_hz": 0, "urn:hertzline:provenance": 0, "tableSchema": {"columns": []}})"}) {
        EXPECT_THAT(warnings_with(same, text),
                    ElementsAre(HasSubstr("no urn:hertzline:sample_rate_hz above 0")));
    }
    EXPECT_THAT(warnings_with(same, R"({"urn:hertzline:sample_rate_hz": 1000})"),
                ElementsAre(HasSubstr("other columns")));
}

TEST(CsvReader, RefusesMetadataThatAreNoJson) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.csv");
    write_text(file, "t_s,v\n0,1\n");
    for (const char* text : {"", "{", "words"}) {
        write_text(file + "-metadata.json", text);
        EXPECT_THAT(error_of([&] { open_csv_reader(file); }), HasSubstr("a.csv-metadata.json")) << text;
    }
}

}  // namespace
}  // namespace hertzline::test
