#include "recordings/formats/wav.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tuple>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/error_of.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline {

using namespace recordings;
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

class Wav : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string file = folder.file("a.wav");

    /// Returns the reason why no writer opens with that head, or "".
    std::string refusal(const RecordingHead& head) const {
        return test::error_of([&] { open_wav_writer(file, head); });
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

TEST_F(Wav, AnotherFullScaleDividesWhatIsInTheFileAndReadsBack) {
    RecordingHead head = test::recording_head(NumberType::float32);
    head.full_scale = 4;
    const RecordedRows rows = test::recorded_rows(head, 0, 1000);
    const auto writer = open_wav_writer(file, head);
    writer->write(rows.first, rows.values);
    writer->commit();
    EXPECT_THAT(test::contents(file), HasSubstr(R"({"full_scale":4,"rows":1000,)"));
    const auto reader = open_wav_reader(file);
    EXPECT_EQ(reader->head().full_scale, 4);
    const auto read = test::read_rows(*reader);
    ASSERT_EQ(read.size(), 1U);
    EXPECT_EQ(read[0].values, rows.values);
    std::string quarter = test::contents(file);
    quarter.replace(quarter.find("full_scale"), 10, "other_name");  // as a program that knows nothing of it
    test::write_text(file, quarter);
    const auto others = test::read_rows(*open_wav_reader(file));
    EXPECT_EQ(others.at(0).values[0], rows.values[0] / 4);
    head.full_scale = 0;
    EXPECT_THROW(open_wav_writer(file, head), std::invalid_argument);
}

TEST_F(Wav, AFullScaleThatIsNoneIsDamage) {
    RecordingHead head = test::recording_head(NumberType::float32);
    head.full_scale = 4.5;
    open_wav_writer(file, head)->commit();
    const std::string whole = test::contents(file);
    for (const char* wrong : {"0.0", "-45", "1e9", "\"5\""}) {
        std::string damaged = whole;
        damaged.replace(damaged.find("4.5"), 3, wrong);
        test::write_text(file, damaged);
        const std::string fault = test::error_of([&] { open_wav_reader(file); });
        EXPECT_EQ(fault.empty(), std::string(wrong) == "1e9") << wrong;
    }
}

TEST_F(Wav, WarnsOfSamplesBeyondTheFullScale) {
    for (const auto& [scale, peak, warns] : {std::tuple{1.0, 1.0, false}, std::tuple{1.0, -1.996, true},
                                             std::tuple{2.0, -1.996, false}, std::tuple{0.5, 0.75, true}}) {
        RecordingHead head = test::recording_head(NumberType::float32);
        head.full_scale = scale;
        const auto writer = open_wav_writer(file, head);
        writer->write(0, std::vector<double>{0.1, 0.2, 0.3, peak, 0.1, 0.2});
        writer->commit();
        EXPECT_EQ(writer->warning().empty(), !warns) << scale << ' ' << peak;
        if (warns) {
            EXPECT_THAT(writer->warning(),
                        HasSubstr(fmt::format("v_out_m_per_s reaches {}, beyond the full scale of {}",
                                              std::abs(peak), scale)));
        }
    }
    RecordingHead head = test::recording_head(NumberType::float32);
    head.full_scale = 1e300;
    const auto zeros = open_wav_writer(folder.file("zeros.wav"), head);
    zeros->write(0, std::vector<double>{0.1, 0.2});
    zeros->commit();
    EXPECT_THAT(zeros->warning(), HasSubstr("reaches 0.2, too little for float32 at a full scale of 1e+300"));
    head.full_scale = 1e-30;
    const auto writer = open_wav_writer(file, head);
    EXPECT_THAT(test::error_of([&] {
                    writer->write(0, std::vector<double>{1e9, 0});
                }),
                HasSubstr("too large for a full scale of 1e-30"));
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

TEST_F(Wav, SamplesBeginAtAMultipleOfEightBytes) {
    for (int spheres = 0; spheres < 12; ++spheres) {
        RecordingHead head = test::recording_head(NumberType::float32, spheres);
        head.provenance["scene"] = std::string(static_cast<std::size_t>(spheres), 's');
        const auto writer = open_wav_writer(file, head);
        const RecordedRows rows = test::recorded_rows(head, 0, 10);
        writer->write(0, rows.values);
        writer->commit();
        const std::vector<float> samples(rows.values.begin(), rows.values.end());
        const std::string text = test::contents(file);
        const std::size_t at =
            text.find(std::string(reinterpret_cast<const char*>(samples.data()), 4 * samples.size()));
        ASSERT_NE(at, std::string::npos);
        EXPECT_EQ(at % 8, 0U) << spheres;
        EXPECT_EQ(test::read_rows(*open_wav_reader(file)).at(0).values, rows.values);
    }
}

/// A WAV of 16 bits, with these lengths in its header.
std::string pcm16(std::uint32_t riff_bytes, std::uint32_t data_bytes, const std::string& samples) {
    return "RIFF" + bytes(riff_bytes, 4) + "WAVEfmt " + bytes(16, 4) + bytes(1, 2) + bytes(1, 2) +
           bytes(48'000, 4) + bytes(96'000, 4) + bytes(2, 2) + bytes(16, 2) + "data" + bytes(data_bytes, 4) +
           samples;
}

TEST_F(Wav, ALengthThatIsNotKnownReachesToTheEnd) {
    const std::string samples = bytes(0x4000, 2) + bytes(0x8000, 2) + bytes(0x2000, 2);
    for (const std::uint32_t told : {0xffffffffU, 0x80000000U, 0x7fffffffU, 0x7ffff000U, 0x7fffeff9U, 0U}) {
        for (const std::uint32_t riff : {told, told == 0 ? 36U : 0xffffffffU}) {
            test::write_text(file, pcm16(riff, told, samples));
            EXPECT_THAT(test::read_rows(*open_wav_reader(file)).at(0).values,
                        testing::ElementsAre(0.5, -1, 0.25))
                << told;
        }
    }
    test::write_text(file, pcm16(42, 6, samples));
    EXPECT_EQ(test::read_rows(*open_wav_reader(file)).at(0).values.size(), 3U);
    test::write_text(file, pcm16(1000, 964, samples));
    EXPECT_THAT(test::error_of([&] { open_wav_reader(file); }), HasSubstr("cut short"));
    test::write_text(file, pcm16(0xffffffff, 964, samples));
    EXPECT_THAT(test::error_of([&] { open_wav_reader(file); }),
                HasSubstr("cut short: chunk \"data\" of 964 bytes"));
    test::write_text(file, pcm16(44, 0, "LIST" + bytes(0, 4)));
    EXPECT_THAT(test::read_rows(*open_wav_reader(file)), testing::IsEmpty());
}

TEST_F(Wav, AnRf64WithoutLengthsReachesToTheEnd) {
    const std::string samples = bytes(0x4000, 2) + bytes(0x8000, 2);
    const auto rf64 = [&](std::uint32_t riff_bytes, std::uint32_t data_bytes) {
        std::string text = pcm16(0xffffffff, 0xffffffff, samples);
        text.replace(0, 4, "RF64");
        return text.insert(12, "ds64" + bytes(28, 4) + bytes(riff_bytes, 4) + bytes(0, 4) +
                                   bytes(data_bytes, 4) + bytes(0, 4) + std::string(12, '\0'));
    };
    test::write_text(file, rf64(0, 0));  // as ffmpeg leaves it in a pipe
    EXPECT_THAT(test::read_rows(*open_wav_reader(file)).at(0).values, testing::ElementsAre(0.5, -1));
    test::write_text(file, rf64(0, 2));
    EXPECT_THAT(test::read_rows(*open_wav_reader(file)).at(0).values, testing::ElementsAre(0.5));
    test::write_text(file, rf64(0, 0xffffffff));
    EXPECT_THAT(test::error_of([&] { open_wav_reader(file); }), HasSubstr("cut short"));
}

TEST_F(Wav, SamplesThatAreNotReadAreWarnedOf) {
    const std::string again = "data" + bytes(4, 4) + bytes(0x2000, 2) + bytes(0x1000, 2);
    for (const auto& [text, left] : {std::pair{pcm16(50, 2, bytes(0x4000, 2) + again), 4},
                                     std::pair{pcm16(40, 3, bytes(0x4000, 2) + bytes(0, 2)), 1}}) {
        test::write_text(file, text);
        std::string warning;
        open_wav_reader(file,
                        {.sample_rate_hz = {}, .warn = [&](const std::string& said) { warning = said; }});
        EXPECT_THAT(warning, HasSubstr(std::to_string(left) + " bytes behind the samples are left out"));
    }
}

TEST_F(Wav, BytesBehindTheSamplesThatAreNoChunkAreWarnedOf) {
    test::write_text(file, pcm16(38, 2, bytes(0x4000, 2) + std::string(100, 'x')));
    std::string warning;
    const auto reader = open_wav_reader(
        file, {.sample_rate_hz = {}, .warn = [&](const std::string& text) { warning = text; }});
    EXPECT_THAT(warning, HasSubstr("100 bytes behind the samples are left out"));
    EXPECT_THAT(test::read_rows(*reader).at(0).values, testing::ElementsAre(0.5));
}

TEST_F(Wav, OtherSoundFilesAreNone) {
    std::ofstream(file, std::ios::binary) << ".snd" << std::string(100, '\0');
    EXPECT_THROW(open_wav_reader(file), std::runtime_error);
}

/// A writer with samples, whose file the test makes 4 GiB longer before it is completed. The disk gives no room for that.
class Rf64 : public Wav {
protected:
    static constexpr std::int64_t part = 1000;  // rows
    const RecordingHead head = test::recording_head(NumberType::float32);
    const std::int64_t row_bytes = std::ssize(head.columns) * 4;
    const std::int64_t hole = (std::int64_t{1} << 32) / row_bytes;  // rows
    const std::vector<double> values = test::recorded_rows(head, 0, part).values;

    // A file system in memory, where reading a hole is fastest.
    const fs::path memory = "/dev/shm/hertzline-rf64-" + std::to_string(::getpid());

    void SetUp() override {
        fs::create_directory(memory);
        file = memory / "a.wav";
        const auto writer = open_wav_writer(file, head);
        writer->write(0, values);
        writer->write(5000, values);
        const fs::path temporary = *fs::directory_iterator(memory);
        fs::resize_file(temporary, static_cast<std::uintmax_t>((hole + 10 * part) * row_bytes));
        writer->commit();
    }
    void TearDown() override { fs::remove_all(memory); }

    std::string begin_of_file(std::size_t count) const {
        std::string text(count, '\0');
        std::ifstream(file, std::ios::binary).read(text.data(), static_cast<std::streamsize>(count));
        return text;
    }

    /// Puts rows of zeros between the two parts.
    void move_the_second_part_beyond_the_hole() const {
        const std::string text = begin_of_file(100'000);
        const std::size_t first = text.find("data\xff\xff\xff\xff") + 8;
        const std::size_t second = first + static_cast<std::size_t>(part * row_bytes);
        const std::size_t after = second + static_cast<std::size_t>(part * row_bytes);
        std::string tail = text.substr(after, text.find('}', after) + 1 - after);
        const std::string was = R"({"rows":2000,"captures":[[0,0],[1000,5000]]})";
        ASSERT_NE(tail.find(was), std::string::npos);
        std::string comment = fmt::format(R"({{"rows":{},"captures":[[0,9]]}})", 2 * part + hole);
        comment.resize(was.size(), ' ');
        tail.replace(tail.find(was), was.size(), comment);

        std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
        const auto overwrite = [&](std::size_t at, const std::string& with) {
            stream.seekp(static_cast<std::streamoff>(at));
            stream << with;
        };
        const auto moved = static_cast<std::size_t>(hole * row_bytes);
        overwrite(second, std::string(100'000 - second, '\0'));
        overwrite(second + moved, text.substr(second, after - second));
        overwrite(after + moved, tail + std::string(16, '\0'));
        overwrite(ds64 + 0, bytes_of(static_cast<std::int64_t>(after + moved + tail.size()) + 8));
        overwrite(ds64 + 8, bytes_of((2 * part + hole) * row_bytes));
        overwrite(ds64 + 16, bytes_of(2 * part + hole));
    }

    static constexpr std::size_t ds64 =
        20;  // where its sizes are: of the file, of the samples, and how many rows

    static std::string bytes_of(std::int64_t number) {
        return bytes(static_cast<std::uint32_t>(number), 4) +
               bytes(static_cast<std::uint32_t>(number >> 32), 4);
    }
};

TEST_F(Rf64, IsWhatAFileBeyondFourGibibytesIs) {
    const std::string text = begin_of_file(ds64 + 8);
    EXPECT_EQ(text.substr(0, 4), "RF64");
    EXPECT_EQ(text.substr(8, 8), "WAVEds64");
    EXPECT_EQ(text.substr(ds64, 8), bytes_of(static_cast<std::int64_t>(fs::file_size(file)) - 8));
    const auto read = test::read_rows(*open_wav_reader(file));
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(read[0].values, values);
    EXPECT_EQ(read[1].first, 5000);
    EXPECT_EQ(read[1].values, values);
    fs::resize_file(file, fs::file_size(file) - 1);
    EXPECT_THAT(test::error_of([&] { open_wav_reader(file); }), HasSubstr("cut short"));
}

TEST_F(Rf64, IsReadBeyondFourGibibytes) {
    move_the_second_part_beyond_the_hole();
    const auto reader = open_wav_reader(file);
    EXPECT_EQ(reader->head().columns, head.columns);
    if (test::sanitized) {
        return;  // a billion numbers take a minute
    }
    std::int64_t due = 9;
    std::vector<double> end;
    for (RecordedRows read; reader->read(read, 100'000);) {
        ASSERT_EQ(read.first, due);
        due += std::ssize(read.values) / std::ssize(head.columns);
        end.insert(end.end(), read.values.begin(), read.values.end());
        end.erase(end.begin(), end.end() - std::min(std::ssize(end), std::ssize(values)));
    }
    EXPECT_EQ(due, 9 + 2 * part + hole);
    EXPECT_EQ(end, values);
}

}  // namespace
}  // namespace hertzline
