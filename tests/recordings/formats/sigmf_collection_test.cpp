// A SigMF collection: a recording for each column, of the same samples.

#include <array>
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sodium.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "recordings/formats/sigmf/sigmf.hpp"
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
using testing::SizeIs;

class SigmfCollection : public testing::Test {
protected:
    TemporaryFolder folder;
    const std::string file = folder.file("a.sigmf-collection");
    const RecordingHead head =
        recording_head({"v_last_m_per_s", "x1_m", "f_last_n"}, 1000, NumberType::float32);

    json listed() const { return json::parse(contents(file))["collection"]["core:streams"]; }
    std::string part(const std::string& column) const { return folder.file("a-" + column + ".sigmf-meta"); }
    std::string data(const std::string& column) const { return folder.file("a-" + column + ".sigmf-data"); }
    std::size_t files() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(fs::path(file).parent_path()), {}));
    }

    /// Checks that each hash is that of the metadata beside it: other programs refuse a collection with a wrong hash.
    void expect_hashes_to_hold() const {
        for (const json& one : listed()) {
            const std::string meta = contents(folder.file(one["name"].get<std::string>() + ".sigmf-meta"));
            std::array<unsigned char, crypto_hash_sha512_BYTES> hash{};
            std::array<char, 2 * hash.size() + 1> digits{};
            crypto_hash_sha512(hash.data(), reinterpret_cast<const unsigned char*>(meta.data()), meta.size());
            sodium_bin2hex(digits.data(), digits.size(), hash.data(), hash.size());
            EXPECT_EQ(one["hash"], digits.data()) << one["name"];
        }
    }

    /// Writes a collection as another program would.
    void write_others(const std::string& name, double rate, const std::string& captures,
                      const std::vector<float>& samples) const {
        write_text(
            folder.file(name + ".sigmf-meta"),
            R"({"global": {"core:datatype": "rf32_le", "core:version": "1.0.0", "core:sample_rate": )" +
                std::to_string(rate) + R"(}, "captures": )" + captures + R"(, "annotations": []})");
        write_text(folder.file(name + ".sigmf-data"),
                   {reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof(float)});
    }
};

TEST_F(SigmfCollection, HasARecordingOfOneChannelForEachColumn) {
    const std::vector<RecordedRows> rows{recorded_rows(head, 7, 300), recorded_rows(head, 5000, 20)};
    const auto writer = open_sigmf_collection_writer(file, head);
    write_rows(*writer, rows);
    writer->commit();
    EXPECT_EQ(files(), 7U);
    expect_hashes_to_hold();
    ASSERT_THAT(listed(), SizeIs(3));
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string& column = head.columns[i].name;
        EXPECT_EQ(listed()[i]["name"], "a-" + column);
        EXPECT_EQ(json::parse(contents(part(column)))["global"]["core:collection"], "a");
        const auto reader = open_sigmf_reader(part(column));
        EXPECT_THAT(reader->head().columns, ElementsAre(head.columns[i]));
        const auto read = read_rows(*reader);
        ASSERT_THAT(read, SizeIs(2));
        EXPECT_EQ(read[1].first, 5000);
        ASSERT_THAT(read[1].values, SizeIs(20));
        for (std::size_t row = 0; row < 20; ++row) {
            EXPECT_EQ(read[1].values[row], rows[1].values[3 * row + i]);
        }
    }
}

TEST_F(SigmfCollection, IsWholeWhileItIsWritten) {
    const auto writer = open_sigmf_collection_writer(file, head);
    std::int64_t due = 0;
    std::size_t written = 0;
    for (int gap = 0; gap < 20; ++gap, due += 17) {
        writer->write(due, recorded_rows(head, due, 130).values);
        due += 130;
        written += 130;
        expect_hashes_to_hold();
        std::size_t held = 0;
        for (const RecordedRows& stretch : read_rows(*open_sigmf_collection_reader(file))) {
            const std::size_t count = stretch.values.size() / 3;
            ASSERT_EQ(stretch.values, recorded_rows(head, stretch.first, count).values)
                << "samples pass for others, from " << stretch.first;
            held += count;
        }
        EXPECT_GT(held + 500, written) << "half a second is missing";
    }
}

TEST_F(SigmfCollection, ReplacesAnotherOneWithItsFirstSample) {
    const auto old = [&] { return contents(file) + contents(part("x1_m")) + contents(data("x1_m")); };
    for (const std::string& name : {file, part("x1_m"), data("x1_m")}) {
        write_text(name, "old");
    }
    { const auto writer = open_sigmf_collection_writer(file, head); }
    EXPECT_EQ(old(), "oldoldold");
    {
        const auto writer = open_sigmf_collection_writer(file, head, Appearance::when_complete);
        writer->write(0, recorded_rows(head, 0, 5000).values);
        EXPECT_EQ(old(), "oldoldold");
        writer->discard();
    }
    EXPECT_EQ(old(), "oldoldold");
    EXPECT_EQ(files(), 3U);
    const auto writer = open_sigmf_collection_writer(file, head);
    writer->write(0, recorded_rows(head, 0, 1).values);
    expect_hashes_to_hold();
}

TEST_F(SigmfCollection, EndsWithTheShortestOfItsFiles) {
    open_sigmf_collection_writer(file, head)->write(0, recorded_rows(head, 0, 2000).values);
    fs::resize_file(data("x1_m"), 700 * sizeof(float) + 3);  // as a kill may leave it
    const auto read = read_rows(*open_sigmf_collection_reader(file), 300);
    ASSERT_THAT(read, SizeIs(1));
    EXPECT_EQ(read[0].values, recorded_rows(head, 0, 700).values);
    fs::remove(data("x1_m"));
    EXPECT_THAT(error_of([&] { open_sigmf_collection_reader(file); }), HasSubstr(data("x1_m")));
}

/// Runs in a process of its own, because the limit on the size of files cannot be raised again.
TEST_F(SigmfCollection, AFullDiskLeavesTheRowsThatAllFilesHave) {
    constexpr std::size_t limit = 100'001;  // bytes; no whole number of samples
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit small{limit, limit};
        setrlimit(RLIMIT_FSIZE, &small);
        auto writer = open_sigmf_collection_writer(file, head);
        std::string error;
        for (std::int64_t first = 0; first < 100'000 && error.empty(); first += 100) {
            error = error_of([&] { writer->write(first, recorded_rows(head, first, 100).values); });
        }
        const KeptRows kept = writer->kept();
        const bool as_promised = error.find("File too large") != std::string::npos &&
                                 kept.rows == limit / sizeof(float) && kept.file == fs::path(file);
        _exit(as_promised ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0) << "no error, or another one";
    const auto read = read_rows(*open_sigmf_collection_reader(file));
    ASSERT_THAT(read, SizeIs(1));
    EXPECT_EQ(read[0].values, recorded_rows(head, 0, limit / sizeof(float)).values);
}

TEST_F(SigmfCollection, KeptBeforeItsEndItLeavesBothFilesOfEachColumn) {
    const auto writer = open_sigmf_collection_writer(file, head, Appearance::when_complete);
    writer->write(0, recorded_rows(head, 0, 3000).values);
    writer->keep();
    EXPECT_EQ(writer->kept().rows, 3000);
    EXPECT_THAT(writer->kept().file.string(), HasSubstr("a-v_last_m_per_s.sigmf-data.partial-"));
    EXPECT_EQ(files(), 6U);
    for (const auto& entry : fs::directory_iterator(fs::path(file).parent_path())) {
        EXPECT_GT(entry.file_size(), 0U);
        EXPECT_THAT(entry.path().string(), HasSubstr(".partial-"));
    }
}

TEST_F(SigmfCollection, WhatCannotBeWrittenIsRefusedBeforeAnythingIsReplaced) {
    RecordingHead wide = recording_head(std::vector<std::string>{}, 1e6);
    for (int i = 0; i < 101; ++i) {
        wide.columns.push_back(column_named("c" + std::to_string(i)));
    }
    EXPECT_THAT(error_of([&] { open_sigmf_collection_writer(file, wide); }),
                HasSubstr("found 101 columns, allowed: at most 100 in a SigMF collection"));
    EXPECT_THAT(error_of([&] { open_sigmf_collection_writer(folder.file("\xff.sigmf-collection"), head); }),
                HasSubstr("UTF-8"));
    write_text(data("v_last_m_per_s"), "old");
    fs::create_directory(part("x1_m"));
    EXPECT_THAT(error_of([&] { open_sigmf_collection_writer(file, head); }), HasSubstr("Is a directory"));
    EXPECT_EQ(contents(data("v_last_m_per_s")), "old");
    EXPECT_EQ(files(), 2U);
}

TEST_F(SigmfCollection, ReadsCollectionsOfOthers) {
    write_others("left", 48000, "[]", {1, 2, 3});
    write_others("right", 48000, "[]", {4, 5, 6});
    for (const char* streams : {R"([["left", "hash"], ["right", "hash"]])",
                                R"([{"name": "left"}, {"name": "right", "hash": "0"}])"}) {
        write_text(file, R"({"collection": {"core:version": "1.0.0", "core:streams": )" +
                             std::string(streams) + "}}");
        std::string warning;
        const auto reader = open_sigmf_collection_reader(
            file, {.sample_rate_hz = {}, .warn = [&](const std::string& text) { warning = text; }});
        EXPECT_THAT(warning, HasSubstr("the metadata in right.sigmf-meta are not those that the collection "
                                       "names: found "));
        EXPECT_EQ(reader->head().columns,
                  (std::vector{column_named("channel_1"), column_named("channel_2")}));
        EXPECT_EQ(reader->head().sample_rate_hz, 48000);
        const auto read = read_rows(*reader);
        ASSERT_THAT(read, SizeIs(1));
        EXPECT_THAT(read[0].values, ElementsAre(1, 4, 2, 5, 3, 6));
    }
}

TEST_F(SigmfCollection, RecordingsThatDoNotGoTogetherAreRefused) {
    const std::string shifted = R"([{"core:sample_start": 0, "core:global_index": 9}])";
    write_others("a", 1000, "[]", {1, 2, 3});
    write_others("slow", 500, "[]", {1, 2, 3});
    write_others("late", 1000, shifted, {1, 2, 3});
    const auto fault = [&](const std::string& other) {
        write_text(file,
                   R"({"collection": {"core:streams": [{"name": "a"}, {"name": ")" + other + R"("}]}})");
        return error_of([&] { read_rows(*open_sigmf_collection_reader(file)); });
    };
    EXPECT_THAT(fault("slow"), HasSubstr(file + ": found sample rates of 1000 and 500 Hz"));
    EXPECT_THAT(fault("late"), HasSubstr(file + ": sample 0 of one recording is sample 9 of another one"));
    EXPECT_THAT(fault("none"), HasSubstr("none.sigmf-"));
    EXPECT_EQ(fault("a"), "");
}

TEST_F(SigmfCollection, NothingOutsideItsFolderIsOpened) {
    const std::string no_file(256, 'a');
    for (const std::string& name :
         std::vector<std::string>{"../a", "/etc/passwd", "sub/a", "", "a\\u0000b", "a\\u001b[2J", no_file}) {
        write_text(file, R"({"collection": {"core:streams": [{"name": ")" + name + R"("}]}})");
        EXPECT_THAT(error_of([&] { open_sigmf_collection_reader(file); }),
                    HasSubstr("allowed: the name of a recording in the same folder"))
            << name;
    }
}

TEST_F(SigmfCollection, ItsNameMayHaveOtherLettersButNoControlCharacters) {
    for (const std::string name : {"gr\u00f6\u00dfe", "a\\b", "\u6ce2"}) {
        const fs::path path = folder.file(name + ".sigmf-collection");
        const auto writer = open_sigmf_collection_writer(path, head);
        writer->write(0, std::vector<double>(head.columns.size(), 1.0));
        writer->commit();
        EXPECT_EQ(open_sigmf_collection_reader(path)->head().columns.size(), head.columns.size()) << name;
    }
    for (const std::string name : {"tab\tb", "line\nb", "\xff", "c\xc2\x9b"}) {
        EXPECT_THAT(
            error_of([&] { open_sigmf_collection_writer(folder.file(name + ".sigmf-collection"), head); }),
            HasSubstr("control characters"))
            << name;
    }
}

TEST_F(SigmfCollection, WhatIsNoneIsRefusedByName) {
    const std::vector<std::string> wrong{"",
                                         "[]",
                                         "{}",
                                         "null",
                                         R"({"collection": 3})",
                                         R"({"collection": {"core:streams": 5}})",
                                         R"({"collection": {"core:streams": []}})",
                                         R"({"collection": {"core:streams": [5]}})",
                                         R"({"collection": {"core:streams": [[]]}})",
                                         R"({"collection": {"core:streams": [{"name": 5}]}})",
                                         std::string(2'000'000, ' ')};
    for (const std::string& text : wrong) {
        write_text(file, text);
        EXPECT_THAT(error_of([&] { open_sigmf_collection_reader(file); }),
                    testing::StartsWith("cannot read " + file + ": "))
            << text.substr(0, 200);
    }
}

}  // namespace
}  // namespace hertzline::test
