// Promises of every format. The properties of one format are in the test of its name.

#include "recordings/recording_formats.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <ostream>
#include <random>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/recordings/any_format.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace recordings;
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

class RecordingFormat : public AnyFormat {
protected:
    void record(const RecordingHead& as, const std::vector<RecordedRows>& rows) const {
        const auto writer = open_recording(file, as);
        write_rows(*writer, rows);
        writer->commit();
    }

    /// Returns the reason why the file cannot be read to its end, or "".
    std::string refusal() const {
        return error_of([&] { read_rows(*open_reader(file)); });
    }
};

/// Formats with one file, which gets its name at commit.
class StagedFormat : public RecordingFormat {};

/// Tests of formats whose description may be that long.
class LongDescription : public RecordingFormat {};

/// Formats whose reader notices missing or damaged parts.
class SealedFormat : public RecordingFormat {};

TEST_P(RecordingFormat, ComesBackBitForBitWithItsHeadAndItsGaps) {
    const RecordingHead written = head(3);
    const std::vector<RecordedRows> rows{recorded_rows(written, 700, 1), recorded_rows(written, 1000, 2500),
                                         recorded_rows(written, 9'000'000'000, 12)};
    record(written, rows);
    const auto reader = open_reader(file);
    EXPECT_EQ(reader->head().columns, written.columns);
    EXPECT_EQ(reader->head().sample_rate_hz, written.sample_rate_hz);
    EXPECT_EQ(reader->head().numbers, written.numbers);
    EXPECT_EQ(reader->head().provenance, written.provenance);
    expect_same(read_rows(*reader), rows);
}

TEST_P(RecordingFormat, PortionsOfWritingAndReadingDoNotMatter) {
    const RecordingHead written = head(1);
    const RecordedRows rows = recorded_rows(written, 5, 40'000);
    const std::size_t columns = written.columns.size();
    const auto writer = open_recording(file, written);
    for (std::size_t at = 0, portion = 1; at < 40'000; at += portion, portion = portion * 2 + 1) {
        portion = std::min(portion, 40'000 - at);
        writer->write(5 + static_cast<std::int64_t>(at),
                      std::span(rows.values).subspan(at * columns, portion * columns));
    }
    writer->write(5 + 40'000, {});
    writer->commit();
    for (const std::size_t most : {std::size_t{7}, std::size_t{4096}, std::size_t{1} << 60}) {
        expect_same(read_rows(*open_reader(file), most), {rows});
    }
}

TEST_P(RecordingFormat, RowsOfAPortionFollowOneAnother) {
    const RecordingHead written = head();
    record(written, {recorded_rows(written, 0, 10), recorded_rows(written, 20, 10)});
    const auto reader = open_reader(file);
    RecordedRows rows;
    EXPECT_TRUE(reader->read(rows, 15));
    EXPECT_EQ(rows.values.size(), 20);  // not across the gap
    EXPECT_TRUE(reader->read(rows, 15));
    EXPECT_EQ(rows.first, 20);
    EXPECT_FALSE(reader->read(rows, 15));
    EXPECT_FALSE(reader->read(rows, 15));
}

TEST_P(RecordingFormat, EmptyRecordingIsWhole) {
    record(head(2), {});
    const auto reader = open_reader(file);
    EXPECT_EQ(reader->head().columns, head(2).columns);
    expect_same(read_rows(*reader), {});
}

TEST_P(StagedFormat, AppearsUnderItsNameOnlyAtCommit) {
    const RecordingHead written = head();
    {
        const auto abandoned = open_recording(file, written);
        write_rows(*abandoned, {recorded_rows(written, 0, 100'000)});
        EXPECT_THAT(listing(), testing::ElementsAre(testing::StartsWith(
                                   "recording." + std::string(GetParam().ending) + ".partial-")));
    }
    EXPECT_THAT(listing(), testing::IsEmpty());
    record(written, {});
    EXPECT_THAT(listing(), testing::ElementsAre(fs::path(file).filename()));
}

TEST_P(StagedFormat, HasANameAsLongAsTheFileSystemAllows) {
    const std::string ending = std::string(".") + GetParam().ending;
    const auto longest = static_cast<std::size_t>(::pathconf(folder.file(".").c_str(), _PC_NAME_MAX));
    file = folder.file(std::string(longest - ending.size(), 'n') + ending);
    record(head(), {recorded_rows(head(), 0, 10)});
    expect_same(read_rows(*open_reader(file)), {recorded_rows(head(), 0, 10)});
    EXPECT_THAT(listing(), testing::ElementsAre(fs::path(file).filename()));
}

TEST_P(StagedFormat, KilledWriterLeavesOnlyTheTemporary) {
    const pid_t child = ::fork();
    if (child == 0) {
        const auto writer = open_recording(file, head());
        write_rows(*writer, {recorded_rows(head(), 0, 100'000)});
        ::raise(SIGKILL);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    ASSERT_THAT(listing(), testing::ElementsAre(HasSubstr(".partial-")));
    if (const std::string ending = GetParam().ending; ending == "npy" || ending == "wav") {
        fs::rename(folder.file(listing().front()), file);
        EXPECT_THAT(error_of([&] { open_reader(file); }), HasSubstr("cut off while it was written"));
    }
}

TEST_P(RecordingFormat, UnwritablePlaceIsToldAtOnce) {
    file = folder.file(std::string("missing/recording.") + GetParam().ending);
    EXPECT_THAT(error_of([&] { open_recording(file, head()); }), HasSubstr("cannot write "));
    EXPECT_THAT(error_of([&] { open_recording(file, head()); }), HasSubstr("missing"));
}

TEST_P(StagedFormat, ADeviceIsRefused) {
    fs::create_symlink("/dev/null", file);
    EXPECT_THAT(error_of([&] { open_recording(file, head()); }), HasSubstr("device or pipe"));
}

TEST_P(RecordingFormat, NumberThatIsNoneEndsTheRecording) {
    const auto writer = open_recording(file, head());
    const std::vector<double> rows{1, 2, 3, std::nan("")};
    EXPECT_THAT(error_of([&] { writer->write(10, rows); }), HasSubstr("v_out_m_per_s of sample 11 is nan"));
    EXPECT_THROW(writer->write(12, std::vector<double>{1, 2}), std::runtime_error);
    EXPECT_THROW(writer->commit(), std::runtime_error);
    EXPECT_EQ(writer->kept().rows, 0);
    EXPECT_THAT(listing(), testing::IsEmpty());
    if (GetParam().numbers == NumberType::float32) {
        const auto another = open_recording(file, head());
        EXPECT_THAT(error_of([&] { another->write(0, std::vector<double>{1e39, 0}); }), HasSubstr("float32"));
    }
}

TEST_P(RecordingFormat, MisuseIsRefused) {
    for (const std::size_t values : {2, 3}) {  // goes back, no whole row
        const auto writer = open_recording(file, head());
        writer->write(10, std::vector<double>{1, 2});
        EXPECT_THROW(writer->write(10, std::vector<double>(values)), std::invalid_argument);
    }
    const auto open = [&](const std::function<void(RecordingHead&)>& change) {
        RecordingHead changed = head();
        change(changed);
        open_recording(folder.file(std::string("misuse.") + GetParam().ending), changed);
    };
    EXPECT_THROW(open([](RecordingHead& h) { h.columns.clear(); }), std::invalid_argument);
    EXPECT_THROW(open([](RecordingHead& h) { h.columns[1].name = h.columns[0].name; }),
                 std::invalid_argument);
    EXPECT_THROW(open([](RecordingHead& h) { h.columns[0].name = "t_s"; }), std::invalid_argument);
    EXPECT_THROW(open([](RecordingHead& h) { h.columns[0].quantity = "../v"; }), std::invalid_argument);
    EXPECT_THROW(open([](RecordingHead& h) { h.sample_rate_hz = 0; }), std::invalid_argument);
}

TEST_P(SealedFormat, FileCutShortAnywhereIsRefused) {
    const RecordingHead written = head(1);
    record(written, {recorded_rows(written, 0, 5000), recorded_rows(written, 6000, 5000)});
    const auto whole = fs::file_size(file);
    for (const double share : {0.999, 0.99, 0.9, 0.6, 0.3, 0.01, 0.001, 0.0}) {
        fs::resize_file(file, static_cast<std::uintmax_t>(share * static_cast<double>(whole)));
        EXPECT_THAT(refusal(), testing::StartsWith("cannot read " + file + ": ")) << share;
    }
}

TEST_P(SealedFormat, ForeignBytesAreRefused) {
    EXPECT_THAT(refusal(), HasSubstr("No such file"));
    std::ofstream(file) << std::string(10'000, 'x');
    EXPECT_THAT(refusal(), testing::StartsWith("cannot read " + file + ": "));
    fs::remove(file);
    fs::create_directory(file);
    EXPECT_THAT(refusal(), HasSubstr("not a regular file"));
}

/// Files with bytes changed at random are read or refused. The sanitizers decide whether that was correct.
TEST_P(SealedFormat, DamageIsNoCrash) {
    const int files = repeated(3000);
    const RecordingHead written = head(1);
    record(written, {recorded_rows(written, 0, 20), recorded_rows(written, 40, 20)});
    std::ifstream in(file, std::ios::binary);
    const std::string good((std::istreambuf_iterator<char>(in)), {});
    std::mt19937 random(3);
    int refused = 0;
    for (int i = 0; i < files; ++i) {
        std::string bad = good;
        for (int k = 0; k < 3; ++k) {
            bad[random() % (k == 0 ? bad.size() : 400)] = static_cast<char>(random());
        }
        std::ofstream(file, std::ios::binary) << bad;
        refused += refusal().empty() ? 0 : 1;
    }
    EXPECT_GT(refused, files / 4);  // damage of samples and of unused bytes is no fault
}

TEST_P(LongDescription, ThatIsMadeToBeSlowIsRefused) {
    RecordingHead written = head();
    for (int key = 0; key < 6500; ++key) {
        written.provenance[fmt::format("{:x}", key)] = 0;
    }
    record(written, {recorded_rows(written, 0, 10)});
    EXPECT_THAT(refusal(), HasSubstr("too many keys"));
}

std::string name_of(const testing::TestParamInfo<Format>& format) {
    std::string ending = format.param.ending;
    std::ranges::replace(ending, '-', '_');
    return ending + (format.param.numbers == NumberType::float32 ? "_f4" : "_f8");
}

INSTANTIATE_TEST_SUITE_P(All, RecordingFormat,
                         testing::Values(npy_f8, npy_f4, h5_f8, h5_f4, wav, csv_f8, csv_f4, sigmf,
                                         sigmf_collection),
                         name_of);
// A WAV has no field for it.
INSTANTIATE_TEST_SUITE_P(All, LongDescription,
                         testing::Values(npy_f8, h5_f8, csv_f8, sigmf, sigmf_collection), name_of);
// SigMF has its name from the first sample on, and CSV has a second file.
INSTANTIATE_TEST_SUITE_P(All, StagedFormat, testing::Values(npy_f8, npy_f4, h5_f8, h5_f4, wav), name_of);
// CSV and SigMF do not store their length.
INSTANTIATE_TEST_SUITE_P(All, SealedFormat, testing::Values(npy_f8, npy_f4, h5_f8, h5_f4, wav), name_of);

}  // namespace
}  // namespace hertzline::test
