// The remains of a recording that fails, is given up or is removed, in every format.

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <ostream>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "recordings/recording_formats.hpp"
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

class FailedRecording : public AnyFormat {};

/// Tests of formats with one file, which gets its name at commit.
class FailedStagedRecording : public FailedRecording {};

/// A recording under a limit of the file's size, as on a full disk. It runs in a process of its own, whose exit status is
/// the result.
class FullDisk {
public:
    enum Status { as_promised, committed, wrong_message, survived, left_behind, wrong_rows, too_few_rows };

    FullDisk(std::string file, rlim_t limit) : file_(std::move(file)) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit size{limit, limit};
        ::setrlimit(RLIMIT_FSIZE, &size);
    }

    /// @param least rows that must be saved
    Status write(const RecordingHead& head, const RecordedRows& rows, std::int64_t least) {
        try {
            const auto writer = open_recording(file_, head);
            const std::size_t columns = head.columns.size();
            bool failed = false;
            for (std::size_t at = 0; at < rows.values.size() && !failed; at += 1000 * columns) {
                const auto part = std::span(rows.values).subspan(at, 1000 * columns);
                failed = fails([&] { writer->write(static_cast<std::int64_t>(at / columns), part); });
                if (at == 9000 * columns) {  // HDF5 is whole twice a second
                    std::this_thread::sleep_for(std::chrono::milliseconds(600));
                }
            }
            if (!failed && !fails([&] { writer->commit(); })) {
                return committed;
            }
            if (!fails([&] { writer->commit(); })) {
                return survived;
            }
            return judge(writer->kept(), rows, columns, least);
        } catch (const std::runtime_error& error) {
            return told(error) ? as_promised : wrong_message;
        }
    }

private:
    bool told(const std::runtime_error& error) const {
        return std::string(error.what()) == "cannot write " + file_ + ": File too large";
    }

    bool fails(const std::function<void()>& work) const {
        try {
            work();
            return false;
        } catch (const std::runtime_error& error) {
            if (!told(error)) {
                ::_exit(wrong_message);
            }
            return true;
        }
    }

    /// Checks that the saved rows are those that were written, and that no other file is left.
    Status judge(const KeptRows& kept, const RecordedRows& rows, std::size_t columns,
                 std::int64_t least) const {
        if (kept.rows > 0) {
            const fs::path readable = file_ + ".kept" + fs::path(file_).extension().string();
            fs::rename(kept.file, readable);
            const auto read = read_rows(*open_reader(readable));
            const auto numbers = static_cast<std::size_t>(kept.rows) * columns;
            if (read.size() != 1 || read[0].values.size() != numbers ||
                !std::equal(read[0].values.begin(), read[0].values.end(), rows.values.begin())) {
                return wrong_rows;
            }
            fs::remove(readable);
        }
        if (kept.rows < least) {
            return too_few_rows;
        }
        return fs::is_empty(fs::path(file_).parent_path()) ? as_promised : left_behind;
    }

    std::string file_;
};

TEST_P(FailedStagedRecording, FullDiskLeavesWhatItHadRoomFor) {
    const RecordingHead written = head(2);
    constexpr std::int64_t all = 60'000;
    const RecordedRows rows = recorded_rows(written, 0, all);
    {
        const auto writer = open_recording(file, written);
        writer->write(0, rows.values);
        writer->commit();
    }
    const auto whole = static_cast<double>(fs::file_size(file));
    fs::remove(file);
    const auto shares = sanitized ? std::vector{0.0, 0.1, 0.7, 1.0}
                                  : std::vector{0.0, 0.0003, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999, 1.0};
    for (const double share : shares) {
        const auto limit = static_cast<rlim_t>(share * whole);
        const bool flushes_by_time = GetParam().ending == std::string("h5");  // and begins with large chunks
        const auto least =
            flushes_by_time ? (share < 0.7 ? 0 : 10'000) : static_cast<std::int64_t>(share * all) - 500;
        testing::internal::CaptureStderr();
        const pid_t child = ::fork();
        if (child == 0) {  // the libraries end, too
            std::exit(FullDisk(file, limit).write(written, rows, least));
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        EXPECT_TRUE(WIFEXITED(status)) << "killed at " << limit << " of " << whole << " bytes";
        EXPECT_EQ(WEXITSTATUS(status), share < 1 ? FullDisk::as_promised : FullDisk::committed)
            << limit << " of " << whole << " bytes";
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        EXPECT_EQ(fs::exists(file), share >= 1);
    }
}

TEST_P(FailedStagedRecording, KeptRecordingIsReadableUnderAnotherName) {
    const RecordingHead written = head(1);
    const std::vector<RecordedRows> rows{recorded_rows(written, 0, 3000), recorded_rows(written, 5000, 2000)};
    const auto writer = open_recording(file, written);
    write_rows(*writer, rows);
    writer->keep();
    EXPECT_EQ(writer->kept().rows, 5000);
    EXPECT_THAT(listing(), testing::ElementsAre(writer->kept().file.filename()));
    EXPECT_THAT(writer->kept().file.string(), HasSubstr(".partial-"));
    fs::rename(writer->kept().file, file);
    expect_same(read_rows(*open_reader(file)), rows);
}

TEST_P(FailedRecording, DiscardedRecordingIsGone) {
    const auto writer = open_recording(file, head());
    write_rows(*writer, {recorded_rows(head(), 0, 100'000)});
    writer->discard();
    EXPECT_THAT(listing(), testing::IsEmpty());
}

TEST_P(FailedRecording, WhatWasWrittenBeforeAWrongRowStays) {
    const RecordedRows rows = recorded_rows(head(), 0, 1000);
    const std::vector<std::pair<std::int64_t, std::vector<double>>> wrong{
        {1000, {1, std::nan("")}}, {999, {1, 2}}, {1000, {1, 2, 3}}};
    for (const auto& [first, values] : wrong) {
        const auto writer = open_recording(file, head());
        writer->write(0, rows.values);
        EXPECT_NE(error_of([&] { writer->write(first, values); }), "");
        EXPECT_EQ(writer->kept().rows, 1000);
        EXPECT_EQ(writer->kept().file, file);
        expect_same(read_rows(*open_reader(file)), {rows});
    }
}

INSTANTIATE_TEST_SUITE_P(All, FailedRecording,
                         testing::Values(npy_f8, npy_f4, h5_f8, h5_f4, wav, csv_f8, sigmf, sigmf_collection));
// SigMF has its name from the first sample on, and CSV has a second file.
INSTANTIATE_TEST_SUITE_P(All, FailedStagedRecording, testing::Values(npy_f8, npy_f4, h5_f8, h5_f4, wav));

}  // namespace
}  // namespace hertzline::test
