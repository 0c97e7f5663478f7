// Recordings of a stream whose scene changes: each format keeps the changes, and no row is missing beside them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "core/scene/json.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_set.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace recordings;

namespace {

Json change(std::int64_t sample, std::int64_t epoch) {
    return {
        {"sample", sample}, {"epoch", epoch}, {"set", {{"drive.cycles", 3.0 + static_cast<double>(epoch)}}}};
}

RecordingHead head_of_run() {
    RecordingHead head = recording_head({"v_out_m_per_s"}, 1000, NumberType::float32);
    head.provenance["run"] = "01234567-89ab-4cde-8f01-23456789abcd";
    head.provenance["scene"]["drive"]["repetition_hz"] = 10;
    return head;
}

class RecordedChanges : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, RecordedChanges,
                         testing::Values("a.sigmf-meta", "a.sigmf-collection", "a.h5", "a.npy", "a.wav",
                                         "a.csv"));

TEST_P(RecordedChanges, ComeBackAndLeaveNoGap) {
    const TemporaryFolder folder;
    const std::string file = folder.file(GetParam());
    const RecordingHead head = head_of_run();
    {
        RecordingSet set(std::vector{file}, head, {}, [](const std::string& text) { ADD_FAILURE() << text; });
        set.note_change(change(0, 1));
        set.write(0, recorded_rows(head, 0, 150).values);
        set.note_change(change(150, 2));
        set.write(150, recorded_rows(head, 150, 250).values);
        set.note_change(change(400, 3));
        set.commit();
        EXPECT_TRUE(set.complete());
    }
    const auto reader = open_reader(file);
    EXPECT_EQ(reader->head().provenance["changes"], Json({change(0, 1), change(150, 2), change(400, 3)}));
    const auto rows = read_rows(*reader);
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].values, recorded_rows(head, 0, 400).values);
}

TEST_P(RecordedChanges, AreNotThoseOfAnOlderFile) {
    const TemporaryFolder folder;
    const std::string file = folder.file(GetParam());
    const RecordingHead head = head_of_run();
    for (const bool changes : {true, false}) {
        const auto writer = open_recording(file, head);
        writer->write(0, recorded_rows(head, 0, 10).values);
        if (changes) {
            writer->note_change(change(10, 1));
        }
        writer->write(10, recorded_rows(head, 10, 10).values);
        writer->commit();
    }
    EXPECT_FALSE(open_reader(file)->head().provenance.contains("changes"));
}

TEST_P(RecordedChanges, AnEmptyListIsNoMissingOne) {
    const TemporaryFolder folder;
    const std::string file = folder.file(GetParam());
    RecordingHead head = head_of_run();
    head.provenance["control"] = true;
    head.provenance["changes"] = Json::array();
    const auto writer = open_recording(file, head);
    writer->write(0, recorded_rows(head, 0, 10).values);
    writer->commit();
    const Json provenance = open_reader(file)->head().provenance;
    EXPECT_EQ(provenance["control"], true);
    EXPECT_EQ(provenance.value("changes", Json("missing")), Json::array());
}

TEST_P(RecordedChanges, ThoseBeforeItsBeginningComeFirst) {  // of a listener that has joined later
    const TemporaryFolder folder;
    const std::string file = folder.file(GetParam());
    RecordingHead head = head_of_run();
    head.provenance["changes"] = Json::array({change(5, 1)});
    const auto writer = open_recording(file, head);
    writer->write(100, recorded_rows(head, 0, 10).values);
    writer->note_change(change(110, 2));
    writer->write(110, recorded_rows(head, 0, 10).values);
    writer->commit();
    EXPECT_EQ(open_reader(file)->head().provenance["changes"], Json({change(5, 1), change(110, 2)}));
}

TEST(RecordedChanges, AWavOutlivesAListThatCannotBeWritten) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.wav");
    const auto writer = open_recording(file, head_of_run());
    writer->write(0, recorded_rows(head_of_run(), 0, 10).values);
    writer->note_change(change(10, 1));
    writer->write(10, recorded_rows(head_of_run(), 10, 10).values);
    std::filesystem::create_directory(file + "-changes.json");
    EXPECT_THAT([&] { writer->commit(); },
                testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("a.wav-changes.json")));
    const KeptRows kept = writer->kept();
    EXPECT_EQ(kept.rows, 20);
    std::filesystem::rename(kept.file, folder.file("kept.wav"));
    const auto reader = open_reader(folder.file("kept.wav"));
    EXPECT_EQ(read_rows(*reader).front().values, recorded_rows(head_of_run(), 0, 20).values);
}

TEST(RecordedChanges, AnyNumberOfThemFitsIntoSigmf) {
    const TemporaryFolder folder;
    const RecordingHead head = head_of_run();
    const auto writer = open_recording(folder.file("a.sigmf-meta"), head);
    constexpr std::int64_t many = 12'000;  // more than captures that it may have
    const std::vector<double> row = recorded_rows(head, 0, 1).values;
    Json expected = Json::array();
    for (std::int64_t i = 0; i < many; ++i) {
        writer->write(i, row);
        expected.push_back(change(i + 1, i + 1));
        writer->note_change(expected.back());
    }
    writer->write(many, row);
    writer->commit();
    const Json meta = Json::parse(contents(folder.file("a.sigmf-meta")));
    EXPECT_EQ(meta["global"]["hertzline:changes"], expected);
    EXPECT_EQ(meta["global"]["hertzline:changes_until_sample"], many + 1);
    std::int64_t noted = 0;
    std::int64_t before = 0;
    for (const Json& one : meta["annotations"]) {
        noted += one.contains("hertzline:change") ? 1 : 0;
        EXPECT_GE(one["core:sample_start"], before);  // as SigMF demands
        before = one["core:sample_start"];
    }
    EXPECT_EQ(noted, many);
    EXPECT_EQ(read_rows(*open_reader(folder.file("a.sigmf-meta")))[0].values.size(), many + 1);
}

TEST(RecordedChanges, SigmfWritesNoMoreOfItsMetadataTheMoreChangesThereAre) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sigmf-meta");
    const RecordingHead head = head_of_run();
    const auto writer = open_recording(file, head);
    const std::vector<double> rows = recorded_rows(head, 0, 600).values;  // so that each write is flushed
    ino_t inode = 0;
    int saves = 0;
    for (std::int64_t i = 0; i < 3000; ++i) {
        writer->write(600 * i, rows);
        writer->note_change(change(600 * (i + 1), i + 1));
        struct stat status {};
        ASSERT_EQ(::stat(file.c_str(), &status), 0);
        saves += status.st_ino != inode ? 1 : 0;  // each replaces the file
        inode = status.st_ino;
    }
    writer->commit();
    EXPECT_LT(saves, 1500);  // each of the first ones, then ever fewer
}

TEST(RecordedChanges, SigmfMarksThem) {
    const TemporaryFolder folder;
    const RecordingHead head = head_of_run();
    const auto writer = open_recording(folder.file("a.sigmf-meta"), head);
    writer->write(0, recorded_rows(head, 0, 150).values);
    writer->note_change(change(150, 1));
    writer->write(150, recorded_rows(head, 150, 250).values);
    writer->commit();
    const Json meta = Json::parse(contents(folder.file("a.sigmf-meta")));
    ASSERT_EQ(meta["captures"].size(), 2U);
    EXPECT_EQ(meta["captures"][1]["core:sample_start"], 150);
    EXPECT_EQ(meta["captures"][1]["core:global_index"], 150);
    std::vector<std::string> labels;
    std::vector<std::int64_t> starts;
    for (const Json& one : meta["annotations"]) {
        labels.push_back(one["core:label"]);
        starts.push_back(one["core:sample_start"]);
    }
    // bursts of 100 samples restart with the epoch
    EXPECT_THAT(labels,
                testing::ElementsAre("burst 0", "burst 1", "epoch 1", "burst 2", "burst 3", "burst 4"));
    EXPECT_THAT(starts, testing::ElementsAre(0, 100, 150, 150, 250, 350));
}

}  // namespace
}  // namespace hertzline::test
