#include "studies/sweep/journal.hpp"

#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/error_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace studies;

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t payload_size = 24;
constexpr std::size_t row_size = 16 + payload_size;

std::vector<std::byte> payload_of(std::int64_t point) {
    std::vector<std::byte> payload(payload_size);
    for (std::size_t i = 0; i < payload.size(); ++i) {
        payload[i] = static_cast<std::byte>(point * 31 + static_cast<std::int64_t>(i));
    }
    return payload;
}

std::vector<std::byte> read(const Journal& journal, std::int64_t point) {
    std::vector<std::byte> payload(payload_size);
    journal.read(point, payload);
    return payload;
}

class JournalOfASweep : public testing::Test {
protected:
    /// With rows of these points.
    void write(const std::vector<std::int64_t>& points) {
        Journal journal(path, Journal::Use::begin);
        journal.begin("what is swept", payload_size);
        journal.load(10);
        for (const std::int64_t point : points) {
            journal.append(point, point % 2 == 0 ? PointStatus::ok : PointStatus::refused, payload_of(point));
        }
        journal.sync();
    }

    TemporaryFolder folder;
    std::string path = folder.file("a.h5.journal");
};

TEST_F(JournalOfASweep, GivesBackItsRowsAndTakesMore) {
    write({7, 2, 5});
    {
        Journal journal(path, Journal::Use::resume);
        EXPECT_EQ(journal.text(), "what is swept");
        EXPECT_EQ(journal.payload_bytes(), payload_size);
        journal.load(10);
        EXPECT_FALSE(journal.has(0));
        EXPECT_TRUE(journal.has(7) && journal.has(2) && journal.has(5));
        EXPECT_EQ(journal.status(7), PointStatus::refused);
        EXPECT_EQ(read(journal, 5), payload_of(5));
        journal.append(0, PointStatus::failed, payload_of(0));
        journal.append(0, PointStatus::ok, payload_of(9));  // the last one counts
    }
    Journal again(path, Journal::Use::read);
    again.load(10);
    EXPECT_EQ(read(again, 0), payload_of(9));
    EXPECT_EQ(again.status(0), PointStatus::ok);
    EXPECT_EQ(read(again, 7), payload_of(7));
    EXPECT_EQ(again.damaged(), 0);
}

TEST_F(JournalOfASweep, LosesOnlyWhatWasTornOff) {
    write({0, 1, 2});
    const auto whole = fs::file_size(path);
    for (std::size_t cut = 1; cut < row_size; cut += 7) {
        fs::resize_file(path, whole - cut);
        {
            Journal journal(path, Journal::Use::resume);
            journal.load(10);
            EXPECT_TRUE(journal.has(1));
            EXPECT_FALSE(journal.has(2));
            journal.append(2, PointStatus::ok, payload_of(2));
        }
        EXPECT_EQ(fs::file_size(path), whole);
        Journal journal(path, Journal::Use::read);
        journal.load(10);
        EXPECT_EQ(read(journal, 2), payload_of(2));
    }
}

TEST_F(JournalOfASweep, PassesOverDamagedRows) {
    write({0, 1, 2});
    {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(-static_cast<std::streamoff>(row_size) - 3, std::ios::end);
        file.put('!');
    }
    Journal journal(path, Journal::Use::resume);
    journal.load(10);
    EXPECT_TRUE(journal.has(0));
    EXPECT_FALSE(journal.has(1));
    EXPECT_TRUE(journal.has(2));
    EXPECT_EQ(journal.damaged(), 1);
}

TEST_F(JournalOfASweep, ABeginningThatWasTornOffBeginsAgain) {
    write({});
    const auto whole = fs::file_size(path);
    for (const std::uintmax_t left : {std::uintmax_t{0}, std::uintmax_t{5}, std::uintmax_t{20}, whole - 1}) {
        fs::resize_file(path, left);
        {
            Journal journal(path, Journal::Use::begin);
            EXPECT_TRUE(journal.is_new());
            EXPECT_THAT(error_of([&] { Journal(path, Journal::Use::begin); }), HasSubstr("in use"));
            journal.begin("again", payload_size);
        }
        EXPECT_EQ(Journal(path, Journal::Use::read).text(), "again");
        fs::remove(path);
        write({});
    }
}

TEST_F(JournalOfASweep, ASecondUserIsRefused) {
    write({1});
    const Journal journal(path, Journal::Use::resume);
    for (const Journal::Use use : {Journal::Use::begin, Journal::Use::resume, Journal::Use::read}) {
        EXPECT_EQ(error_of([&] { Journal(path, use); }), path + " is in use by another sweep or search");
    }
}

TEST_F(JournalOfASweep, WhatIsNotOneIsRefused) {
    std::ofstream(path) << "important text";
    EXPECT_THAT(error_of([&] { Journal(path, Journal::Use::resume); }), HasSubstr("it is no journal"));
    std::ifstream in(path);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "important text");
    EXPECT_THAT(error_of([&] { Journal(folder.file("none"), Journal::Use::read); }),
                HasSubstr("No such file"));
    EXPECT_THAT(error_of([&] { Journal(folder.file("no/where"), Journal::Use::begin); }),
                HasSubstr("No such file"));
    ::mkfifo(folder.file("fifo").c_str(), 0600);
    EXPECT_THAT(error_of([&] { Journal(folder.file("fifo"), Journal::Use::resume); }),
                HasSubstr("it is no file"));
}

TEST_F(JournalOfASweep, ADamagedBeginningIsRefused) {
    write({1});
    {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(30);
        file.put('!');
    }
    EXPECT_THAT(error_of([&] { Journal(path, Journal::Use::resume); }),
                HasSubstr("its beginning is damaged"));
}

TEST_F(JournalOfASweep, RowsOfAnUnfinishedOneAreNotOverwritten) {
    write({1});
    EXPECT_THAT(error_of([&] { Journal(path, Journal::Use::begin); }), HasSubstr("--resume"));
}

}  // namespace

}  // namespace hertzline::test
