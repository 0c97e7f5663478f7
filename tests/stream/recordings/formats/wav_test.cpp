#include "stream/recordings/formats/wav/wav.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline {

using namespace stream;
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

class Wav : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string file = folder.file("a.wav");

    /// Why no writer opens with that head; empty when one does.
    std::string refusal(const RecordingHead& head) const {
        try {
            open_wav_writer(file, head);
            return {};
        } catch (const std::runtime_error& error) {
            return error.what();
        }
    }
};

std::string bytes(std::uint32_t number, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) {
        text += static_cast<char>(number >> (8 * i));
    }
    return text;
}

TEST_F(Wav, SaysWhatItCannotHold) {
    RecordingHead head = test::recording_head(NumberType::float32);
    head.sample_rate_hz = 10e6 / 3;
    EXPECT_THAT(refusal(head),
                HasSubstr("found a sample rate of 3333333.3333333335 Hz, allowed in WAV: integers"));
    head.sample_rate_hz = 3e9;
    EXPECT_THAT(refusal(head), HasSubstr("up to 2147483647"));
    head = test::recording_head(NumberType::float32, 27);
    EXPECT_THAT(refusal(head), HasSubstr("56 columns of 10000000 Hz are 2240000000 bytes a second"));
    head.sample_rate_hz = 1e6;
    EXPECT_EQ(refusal(head), "");
    head = test::recording_head(NumberType::float32, 600);
    head.sample_rate_hz = 1e3;
    EXPECT_THAT(refusal(head), HasSubstr("found 1202 columns, allowed in WAV: at most 1024"));
    head = test::recording_head(NumberType::float32);
    head.provenance["scene"] = std::string(60'000, 's');
    EXPECT_THAT(refusal(head), HasSubstr("allowed in WAV: 49152"));
    EXPECT_TRUE(fs::is_empty(fs::path(file).parent_path()));
}

TEST_F(Wav, LongestDescriptionRoundTrips) {
    RecordingHead head = test::recording_head(NumberType::float32);
    head.provenance["scene"] = std::string(48'900, 's');
    for (int i = 0; i < 4; ++i) {  // lengths that are whole words, and others
        head.provenance["scene"] = head.provenance["scene"].get<std::string>() + "e";
        const auto writer = open_wav_writer(file, head);
        writer->write(0, std::vector<double>{1, 2});
        writer->commit();
        const auto reader = open_wav_reader(file);
        EXPECT_EQ(reader->head().provenance, head.provenance);
        EXPECT_EQ(test::read_rows(*reader).size(), 1);
    }
}

TEST_F(Wav, IsCompletedBeforeAGapThatItCannotNote) {
    const RecordingHead head = test::recording_head(NumberType::float32);
    const auto writer = open_wav_writer(file, head);
    std::int64_t gaps = 0;
    std::string message;
    while (message.empty() && gaps < 10'000) {
        try {
            writer->write(1'000'000 * gaps, std::vector<double>{1, 2});
            ++gaps;
        } catch (const std::runtime_error& error) {
            message = error.what();
        }
    }
    EXPECT_GT(gaps, 80);
    EXPECT_EQ(message, file + " ends before sample " + std::to_string(1'000'000 * gaps) +
                           ": a WAV has no room for another gap");
    EXPECT_THROW(writer->commit(), std::runtime_error);
    const auto read = test::read_rows(*open_wav_reader(file));
    ASSERT_EQ(static_cast<std::int64_t>(read.size()), gaps);
    EXPECT_EQ(read.back().first, 1'000'000 * (gaps - 1));
}

TEST_F(Wav, PcmOfOthersHasChannelsFromMinusOneToOne) {
    const std::string samples = bytes(0x4000, 2) + bytes(0x8000, 2);
    const std::string wav = "WAVEfmt " + bytes(16, 4) + bytes(1, 2) + bytes(2, 2) + bytes(48'000, 4) +
                            bytes(48'000 * 4, 4) + bytes(4, 2) + bytes(16, 2) + "data" + bytes(4, 4) +
                            samples;
    std::ofstream(file, std::ios::binary) << "RIFF" + bytes(static_cast<std::uint32_t>(wav.size()), 4) + wav;
    const auto reader = open_wav_reader(file);
    EXPECT_EQ(reader->head().sample_rate_hz, 48'000);
    EXPECT_EQ(reader->head().columns.at(1), (Column{"channel_2", "channel_2", ""}));
    EXPECT_THAT(test::read_rows(*reader).at(0).values, testing::ElementsAre(0.5, -1));
}

TEST_F(Wav, OtherSoundFilesAreNone) {
    std::ofstream(file, std::ios::binary) << ".snd" << std::string(100, '\0');
    EXPECT_THROW(open_wav_reader(file), std::runtime_error);
}

/// By hand, since it writes 4.4 GB: test_stream --gtest_also_run_disabled_tests --gtest_filter='Wav.DISABLED*'
TEST_F(Wav, DISABLED_BeyondFourGibibytesIsRf64) {
    const RecordingHead head = test::recording_head(NumberType::float32);
    const std::size_t portion = 500'000, portions = 1100;
    std::vector<double> values = test::recorded_rows(head, 0, portion).values;
    {
        const auto writer = open_wav_writer(file, head);
        for (std::size_t i = 0; i < portions; ++i) {
            values.front() = static_cast<double>(i);
            writer->write(static_cast<std::int64_t>(i * portion) + (i == portions - 1 ? 7 : 0), values);
        }
        writer->commit();
    }
    EXPECT_GT(fs::file_size(file), std::uintmax_t{1} << 32);
    std::string kind(4, '\0');
    std::ifstream(file, std::ios::binary).read(kind.data(), 4);
    EXPECT_EQ(kind, "RF64");
    const auto reader = open_wav_reader(file);
    EXPECT_EQ(reader->head().columns, head.columns);
    std::size_t row = 0;
    std::int64_t last = 0;
    for (RecordedRows rows; reader->read(rows, 50'000);) {
        values.front() = static_cast<double>(row / portion);
        const auto from = values.begin() + static_cast<std::ptrdiff_t>(2 * (row % portion));
        ASSERT_TRUE(std::equal(rows.values.begin(), rows.values.end(), from)) << row;
        row += rows.values.size() / 2;
        last = rows.first + static_cast<std::int64_t>(rows.values.size() / 2);
    }
    EXPECT_EQ(row, portion * portions);
    EXPECT_EQ(last, static_cast<std::int64_t>(portion * portions) + 7);
}

}  // namespace
}  // namespace hertzline
