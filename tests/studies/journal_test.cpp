#include "studies/journal.hpp"

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "studies/database.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace studies;
using recordings::Cell;
using recordings::CellKind;
using recordings::TableColumn;
using recordings::TableRow;

namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;

constexpr std::size_t samples = 3;
constexpr std::int64_t study_points = 10;

const std::vector<TableColumn> study_columns{{{"point", "", ""}, CellKind::integer},
                                             {{"chain.spheres", "", ""}, CellKind::integer},
                                             {{"status", "", ""}, CellKind::text, 12},
                                             {{"thd_r", "", ""}},
                                             {{"message", "", ""}, CellKind::text, 504}};

TableRow row_of(std::int64_t point, double number, PointStatus status = PointStatus::ok) {
    return {{point, point * 31, std::string(word_of(status)), number, std::string("a \"message\", one")},
            {1.5F, -0.0F, static_cast<float>(point)}};
}

class JournalOfAStudy : public testing::Test {
protected:
    /// Makes a journal with rows of these points.
    Journal begun(const std::vector<std::int64_t>& rows) const {
        Journal journal(path, Journal::Use::begin);
        journal.begin("what is studied", study_columns);
        journal.load(study_columns, samples, study_points);
        for (const std::int64_t point : rows) {
            journal.append(PointStatus::ok, row_of(point, 0.5));
        }
        journal.commit();
        return journal;
    }
    void write(const std::vector<std::int64_t>& rows) const { begun(rows); }

    Journal opened(Journal::Use use) const {
        Journal journal(path, use);
        journal.load(study_columns, samples, study_points);
        return journal;
    }

    TemporaryFolder folder;
    std::string path = folder.file("a.h5.journal");
};

double number_in(const Journal& journal, std::int64_t point) {
    TableRow row;
    journal.read(point, row);
    return std::get<double>(row.cells[3]);
}

TEST_F(JournalOfAStudy, GivesBackItsRowsAndTakesMore) {
    write({7, 2, 5});
    {
        Journal journal = opened(Journal::Use::resume);
        EXPECT_EQ(journal.text(), "what is studied");
        EXPECT_TRUE(journal.has_rows());
        EXPECT_FALSE(journal.has(0));
        EXPECT_TRUE(journal.has(7) && journal.has(2) && journal.has(5));
        TableRow row;
        journal.read(5, row);
        EXPECT_EQ(row.cells, row_of(5, 0.5).cells);
        EXPECT_EQ(row.samples, row_of(5, 0.5).samples);
        journal.append(PointStatus::failed, row_of(0, 1, PointStatus::failed));
        journal.append(PointStatus::refused, row_of(0, 2, PointStatus::refused));  // the last one counts
        journal.commit();
    }
    const Journal again = opened(Journal::Use::read);
    EXPECT_EQ(number_in(again, 0), 2);
    EXPECT_EQ(again.status(0), PointStatus::refused);
    EXPECT_EQ(again.status(7), PointStatus::ok);
}

TEST_F(JournalOfAStudy, KeepsEveryNumberToTheBit) {
    using Limits = std::numeric_limits<double>;
    const std::vector<double> numbers{0.0,
                                      -0.0,
                                      1e-310,
                                      Limits::denorm_min(),
                                      -Limits::max(),
                                      Limits::infinity(),
                                      -Limits::infinity(),
                                      9007199254740993.0,
                                      0.1};
    {
        Journal journal = begun({});
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            journal.append(PointStatus::ok, row_of(static_cast<std::int64_t>(i), numbers[i]));
        }
        journal.append(PointStatus::ok, row_of(9, Limits::quiet_NaN()));
        journal.commit();
    }
    const Journal journal = opened(Journal::Use::read);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(number_in(journal, static_cast<std::int64_t>(i))),
                  std::bit_cast<std::uint64_t>(numbers[i]))
            << numbers[i];
    }
    EXPECT_TRUE(std::isnan(number_in(journal, 9)));
}

TEST_F(JournalOfAStudy, LosesOnlyWhatWasNotCommitted) {
    {
        Journal journal = begun({1});
        journal.append(PointStatus::ok, row_of(2, 0.5));
        EXPECT_TRUE(journal.has(2));
    }
    const Journal journal = opened(Journal::Use::resume);
    EXPECT_TRUE(journal.has(1));
    EXPECT_FALSE(journal.has(2));
}

TEST_F(JournalOfAStudy, IsReadWhileItGrows) {
    Journal journal = begun({1});
    journal.append(PointStatus::ok, row_of(2, 0.5));
    {
        const Journal reader = opened(Journal::Use::read);
        EXPECT_TRUE(reader.has(1));
        EXPECT_FALSE(reader.has(2));
        journal.commit_when_due();  // waits for the reader, and fails nothing
        journal.append(PointStatus::ok, row_of(3, 0.5));
    }
    journal.commit();
    const Journal reader = opened(Journal::Use::read);
    EXPECT_TRUE(reader.has(2) && reader.has(3));
}

TEST_F(JournalOfAStudy, IsATableOfPlainColumns) {
    write({4});
    const Database database(path, Database::Use::read);
    Statement query(database, R"(SELECT "chain.spheres", thd_r FROM points WHERE status = 'ok')");
    ASSERT_TRUE(query.step());
    EXPECT_EQ(query.integer(0), 4 * 31);
    EXPECT_EQ(query.number(1), 0.5);
}

TEST_F(JournalOfAStudy, ASecondStudyIsRefused) {
    const Journal journal = begun({1});
    for (const Journal::Use use : {Journal::Use::begin, Journal::Use::resume}) {
        EXPECT_EQ(error_of([&] { Journal(path, use); }), path + " is in use by another sweep or search");
    }
}

TEST_F(JournalOfAStudy, WithoutRowsBeginsAgain) {
    write({});
    Journal journal(path, Journal::Use::begin);
    EXPECT_TRUE(journal.is_new());
    journal.begin("again", study_columns);
    journal.load(study_columns, samples, study_points);
    journal.commit();
    EXPECT_EQ(Journal(path, Journal::Use::read).text(), "again");
}

TEST_F(JournalOfAStudy, RowsOfAnUnfinishedOneAreNotOverwritten) {
    write({1});
    EXPECT_THAT(error_of([&] { Journal(path, Journal::Use::begin); }), HasSubstr("--resume"));
}

TEST_F(JournalOfAStudy, WhatIsNotOneIsRefused) {
    const auto refused = [&](Journal::Use use) { return error_of([&] { Journal(path, use); }); };
    std::ofstream(path)
        << "important text, which is longer than a hundred characters, as the head of a SQLite "
           "file is a hundred bytes long";
    const std::string before(std::istreambuf_iterator<char>(std::ifstream(path).rdbuf()), {});
    EXPECT_THAT(refused(Journal::Use::resume), HasSubstr("it is no journal"));
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(std::ifstream(path).rdbuf()), {}), before);
    fs::remove(path);
    Database(path, Database::Use::write).run("CREATE TABLE important (text TEXT)");
    for (const Journal::Use use : {Journal::Use::begin, Journal::Use::resume, Journal::Use::read}) {
        EXPECT_THAT(refused(use), HasSubstr("it is no journal"));
    }
    EXPECT_THAT(error_of([&] { Journal(folder.file("none"), Journal::Use::read); }),
                HasSubstr("No such file"));
    EXPECT_THAT(error_of([&] { Journal(folder.file("no/where"), Journal::Use::begin); }),
                HasSubstr("No such file"));
    ::mkfifo(folder.file("fifo").c_str(), 0600);
    EXPECT_THAT(error_of([&] { Journal(folder.file("fifo"), Journal::Use::resume); }), HasSubstr("fifo"));
}

TEST_F(JournalOfAStudy, RowsThatAreNotItsOwnAreRefused) {
    write({1, 2});
    const auto error_after = [&](const std::string& sql) {
        fs::copy_file(path, folder.file("copy"), fs::copy_options::overwrite_existing);
        Database(folder.file("copy"), Database::Use::write).run(sql);
        return error_of([&] {
            Journal journal(folder.file("copy"), Journal::Use::read);
            journal.load(study_columns, samples, study_points);
            TableRow row;
            journal.read(1, row);
        });
    };
    EXPECT_EQ(error_after("SELECT 1"), "");
    EXPECT_THAT(error_after("UPDATE points SET point = 10 WHERE point = 1"), HasSubstr("row of point 10"));
    EXPECT_THAT(error_after("UPDATE points SET status = 'fine' WHERE point = 1"), HasSubstr("\"fine\""));
    EXPECT_THAT(error_after("UPDATE points SET thd_r = 'many' WHERE point = 1"),
                HasSubstr("point 1 is damaged"));
    EXPECT_THAT(error_after("UPDATE points SET samples = x'00'"), HasSubstr("point 1 is damaged"));
    EXPECT_THAT(error_after("ALTER TABLE points RENAME COLUMN thd_r TO other"), HasSubstr("thd_r"));
    EXPECT_THAT(error_after("DROP TABLE points"), HasSubstr("points"));
    EXPECT_THAT(error_after("DELETE FROM about"), HasSubstr("no identity of a study"));
}

TEST_F(JournalOfAStudy, DamageIsAnErrorOrAnotherRow) {
    write({0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
    const std::string whole(std::istreambuf_iterator<char>(std::ifstream(path).rdbuf()), {});
    std::mt19937_64 random(1);
    int refused = 0;
    for (int i = 0; i < 500; ++i) {
        std::string damaged = whole;
        if (i % 5 == 0) {
            damaged.resize(random() % whole.size());
        } else {
            damaged[random() % whole.size()] = static_cast<char>(random());
        }
        std::ofstream(path, std::ios::binary) << damaged;
        const std::string error = error_of([&] {
            const Journal journal = opened(Journal::Use::resume);
            TableRow row;
            for (std::int64_t point = 0; point < study_points; ++point) {
                if (journal.has(point)) {
                    journal.read(point, row);
                    EXPECT_EQ(row.cells.size(), study_columns.size());
                }
            }
        });
        refused += error.empty() ? 0 : 1;
        fs::remove(path + "-journal");
    }
    EXPECT_GT(refused, 80);
    EXPECT_LT(refused, 490);
}

TEST(JournalInMemory, HasNoFile) {
    const TemporaryFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.file(""));
    {
        Journal journal = Journal::in_memory();
        EXPECT_TRUE(journal.is_new() && journal.is_in_memory());
        journal.begin("text", study_columns);
        journal.load(study_columns, samples, study_points);
        journal.append(PointStatus::ok, row_of(3, -0.0));
        journal.commit();
        EXPECT_TRUE(std::signbit(number_in(journal, 3)));
        journal.remove();
        EXPECT_TRUE(fs::is_empty(folder.file("")));
    }
    fs::current_path(before);
}

TEST(JournalInMemory, TakesNamesThatDifferInCaseAlone) {
    std::vector<TableColumn> names = study_columns;
    names.push_back({{"materials.Glass.density_kg_per_m3", "", ""}});
    names.push_back({{"materials.glass.density_kg_per_m3", "", ""}});
    Journal journal = Journal::in_memory();
    journal.begin("text", names);
    journal.load(names, samples, study_points);
    TableRow row = row_of(1, 1);
    row.cells.insert(row.cells.end(), {Cell(2.0), Cell(3.0)});
    journal.append(PointStatus::ok, row);
    TableRow again;
    journal.read(1, again);
    EXPECT_EQ(again.cells, row.cells);
}

}  // namespace

}  // namespace hertzline::test
