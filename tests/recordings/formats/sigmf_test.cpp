#include "recordings/formats/sigmf/sigmf.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <numeric>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "measures/provenance.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace measures;
using namespace recordings;
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::vector<std::string> two{"v_last_m_per_s", "x1_m"};

/// Returns rows of two columns as SigMF stores them.
std::vector<double> numbered_rows(std::int64_t first, std::int64_t count) {
    const RecordingHead head = recording_head(two, 1000, NumberType::float32);
    return recorded_rows(head, first, static_cast<std::size_t>(count)).values;
}

class Sigmf : public testing::Test {
protected:
    TemporaryFolder folder;
    const std::string meta_file = folder.file("a.sigmf-meta");
    const std::string data_file = folder.file("a.sigmf-data");

    json meta() const { return json::parse(contents(meta_file)); }
    std::size_t files() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(fs::path(meta_file).parent_path()), {}));
    }
};

TEST_F(Sigmf, ReadsBackWithItsGapsUnderEitherName) {
    const RecordingHead head = recording_head(two, 1000, NumberType::float32);
    const std::vector<RecordedRows> rows{recorded_rows(head, 7, 300), recorded_rows(head, 5000, 1)};
    for (const std::string& name : {meta_file, data_file}) {
        const auto writer = open_sigmf_writer(name, head);
        write_rows(*writer, rows);
        writer->commit();
        const auto read = read_rows(*open_sigmf_reader(name));
        ASSERT_THAT(read, SizeIs(2));
        EXPECT_EQ(read[1].first, 5000);
        EXPECT_EQ(read[0].values, rows[0].values);
    }
    EXPECT_EQ(files(), 2U);
}

TEST_F(Sigmf, LostSamplesAreANewCapture) {
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 10e6));
    writer->write(100, numbered_rows(100, 50));
    writer->write(150, numbered_rows(150, 50));
    writer->write(1000, numbered_rows(1000, 10));
    writer->commit();
    const json captures = meta()["captures"];
    ASSERT_THAT(captures, SizeIs(2));
    EXPECT_EQ(captures[0]["core:sample_start"], 0);
    EXPECT_EQ(captures[0]["core:global_index"], 100);
    EXPECT_EQ(captures[1]["core:sample_start"], 100);
    EXPECT_EQ(captures[1]["core:global_index"], 1000);
    EXPECT_EQ(fs::file_size(data_file), 110U * 2 * sizeof(float));
}

TEST_F(Sigmf, ACaptureHasTheTimeAtWhichItsFirstSampleWasWritten) {
    const auto now = [] { return utc_text(std::chrono::system_clock::now()); };  // sorts as time does
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 10e6));
    std::vector<std::string> before;
    std::vector<std::string> after;
    for (const std::int64_t first : {0, 1000}) {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        before.push_back(now());
        writer->write(first, numbered_rows(first, 1));
        after.push_back(now());
    }
    writer->commit();
    for (std::size_t i = 0; i < 2; ++i) {
        const std::string time = meta()["captures"][i]["core:datetime"];
        EXPECT_GE(time, before[i]);
        EXPECT_LE(time, after[i]);
    }
}

TEST_F(Sigmf, IsWholeWhileItIsWritten) {
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 1000));
    for (std::int64_t first = 0; first < 10'000; first += 100) {  // of simulated time: ten seconds
        writer->write(first, numbered_rows(first, 100));
        const auto read = read_rows(*open_sigmf_reader(meta_file));
        const std::size_t held = read.empty() ? 0 : read[0].values.size() / 2;
        EXPECT_GT(held + 500, static_cast<std::size_t>(first) + 100) << "half a second is missing";
        if (held > 0) {
            EXPECT_EQ(read[0].values, numbered_rows(0, static_cast<std::int64_t>(held)));
        }
    }
}

TEST_F(Sigmf, IsWrittenOutAfterHalfASecondHoweverFewItsSamples) {
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 1e6));
    writer->write(0, numbered_rows(0, 100));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    writer->write(100, numbered_rows(100, 100));
    EXPECT_EQ(read_rows(*open_sigmf_reader(meta_file)).at(0).values, numbered_rows(0, 200));
}

TEST_F(Sigmf, ACaptureIsKnownBeforeItsSamplesAreThere) {
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 1000));
    writer->write(0, numbered_rows(0, 500));
    std::int64_t due = 500;
    for (int gap = 0; gap < 20; ++gap) {
        due += 17;
        writer->write(due, numbered_rows(due, 130));
        due += 130;
        for (const RecordedRows& stretch : read_rows(*open_sigmf_reader(meta_file))) {
            const auto count = static_cast<std::int64_t>(stretch.values.size() / 2);
            ASSERT_EQ(stretch.values, numbered_rows(stretch.first, count))
                << "samples pass for others, from " << stretch.first;
        }
    }
}

/// Returns the head of a scene with 2.5 bursts a second.
RecordingHead head_with_bursts(double sample_rate_hz) {
    RecordingHead head = recording_head(two, sample_rate_hz);
    head.provenance["scene"]["drive"]["repetition_hz"] = 2.5;
    return head;
}

class SigmfBursts : public Sigmf, public testing::WithParamInterface<Appearance> {};
INSTANTIATE_TEST_SUITE_P(Appearances, SigmfBursts,
                         testing::Values(Appearance::early, Appearance::when_complete));

TEST_P(SigmfBursts, AreAnnotated) {
    const auto writer =
        open_sigmf_writer(meta_file, head_with_bursts(1001), GetParam());  // 400.4 samples each
    writer->write(300, numbered_rows(300, 500));
    writer->write(1000, numbered_rows(1000, 500));
    writer->commit();
    struct Expected {
        std::int64_t burst, start, count;
    };
    // bursts begin at 0, 401, 801, 1202 and 1602; 800 to 999 are missing
    const std::vector<Expected> expected{{0, 0, 101}, {1, 101, 399}, {2, 500, 202}, {3, 702, 298}};
    const json annotations = meta()["annotations"];
    ASSERT_THAT(annotations, SizeIs(expected.size()));
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(annotations[i]["hertzline:burst"], expected[i].burst);
        EXPECT_EQ(annotations[i]["core:label"], "burst " + std::to_string(expected[i].burst));
        EXPECT_EQ(annotations[i]["core:sample_start"], expected[i].start);
        EXPECT_EQ(annotations[i]["core:sample_count"], expected[i].count);
    }
}

TEST_F(Sigmf, AnnotationsAreOfSamplesThatAreThere) {
    const auto writer = open_sigmf_writer(meta_file, head_with_bursts(1000));
    std::size_t most = 0;
    for (std::int64_t first = 0; first < 10'000; first += 100) {
        writer->write(first, numbered_rows(first, 100));
        const auto read = read_rows(*open_sigmf_reader(meta_file));
        const std::size_t held = read.empty() ? 0 : read[0].values.size() / 2;
        const json annotations = meta()["annotations"];
        most = annotations.size();
        EXPECT_EQ(most, held / 400) << "those that are complete";
    }
    EXPECT_GT(most, 20U);
}

TEST_F(Sigmf, NoMoreThanAThousandBurstsAreAnnotated) {
    RecordingHead head = recording_head(two, 1000);
    head.provenance["scene"]["drive"]["repetition_hz"] = 500.0;
    const auto writer = open_sigmf_writer(meta_file, head);
    writer->write(0, numbered_rows(0, 3000));
    writer->commit();
    const json annotations = meta()["annotations"];
    ASSERT_THAT(annotations, SizeIs(1000));
    EXPECT_EQ(annotations.back()["core:sample_start"], 1998);
}

TEST_F(Sigmf, ASingleBurstIsTheWholeRecordingAndOfNoSceneThereAreNone) {
    RecordingHead head = recording_head(two, 1000);
    head.provenance["scene"]["drive"]["repetition_hz"] = 0.0;
    const auto writer = open_sigmf_writer(meta_file, head);
    writer->write(0, numbered_rows(0, 700));
    writer->commit();
    ASSERT_THAT(meta()["annotations"], SizeIs(1));
    EXPECT_EQ(meta()["annotations"][0]["core:sample_count"], 700);
    const auto foreign = open_sigmf_writer(meta_file, recording_head(two, 1000));
    foreign->write(0, numbered_rows(0, 700));
    foreign->commit();
    EXPECT_THAT(meta()["annotations"], IsEmpty());
}

TEST_F(Sigmf, WithoutCommitWhatWasFlushedStays) {
    open_sigmf_writer(meta_file, recording_head(two, 1000))->write(0, numbered_rows(0, 5000));
    EXPECT_EQ(read_rows(*open_sigmf_reader(meta_file)).at(0).values, numbered_rows(0, 5000));
}

TEST_F(Sigmf, MetadataOfAnotherRecordingAreLeftAlone) {
    const auto first = open_sigmf_writer(meta_file, recording_head(two, 1000));
    first->write(0, numbered_rows(0, 1000));
    const std::string other = folder.file("b.sigmf-");
    const auto second = open_sigmf_writer(other + "meta", recording_head(two, 2000));
    second->write(0, numbered_rows(0, 2000));
    fs::rename(other + "meta", meta_file);
    fs::rename(other + "data", data_file);
    EXPECT_THAT(error_of([&] { first->write(5000, numbered_rows(5000, 1000)); }), HasSubstr("No such file"));
    EXPECT_EQ(first->kept().rows, 0);
    EXPECT_EQ(meta()["global"]["core:sample_rate"], 2000);
}

TEST_F(Sigmf, TheOldRecordingStaysUntilTheFirstSample) {
    write_text(meta_file, "old");
    write_text(data_file, "old");
    { const auto writer = open_sigmf_writer(meta_file, recording_head(two, 1000)); }
    EXPECT_EQ(contents(meta_file) + contents(data_file), "oldold");
    open_sigmf_writer(meta_file, recording_head(two, 1000))->commit();
    EXPECT_THAT(read_rows(*open_sigmf_reader(meta_file)), IsEmpty());
    EXPECT_EQ(files(), 2U);
}

TEST_F(Sigmf, WhatCannotBeWrittenIsRefusedBeforeAnythingIsReplaced) {
    const auto fault = [&](const RecordingHead& head) {
        return error_of([&] { open_sigmf_writer(meta_file, head); });
    };
    RecordingHead wide = recording_head(std::vector<std::string>{}, 1e6);
    for (int i = 0; i < 1001; ++i) {
        wide.columns.push_back(column_named("c" + std::to_string(i)));
    }
    EXPECT_THAT(fault(wide), HasSubstr("found 1001 columns, allowed: at most 1000"));
    EXPECT_THAT(fault(recording_head(two, 0.5)), HasSubstr("0.5 samples per second"));
    fs::create_directory(meta_file);
    write_text(data_file, "old");
    EXPECT_THAT(fault(recording_head(two, 1)), HasSubstr("Is a directory"));
    EXPECT_EQ(contents(data_file), "old");
    EXPECT_THAT(error_of([&] { open_sigmf_writer(folder.file("no/a.sigmf-meta"), recording_head(two, 1)); }),
                HasSubstr("No such file"));
}

TEST_F(Sigmf, ARecordingThatStillGrowsIsNotReplaced) {
    const RecordingHead head = recording_head(two, 1000);
    const auto growing = open_sigmf_writer(meta_file, head);
    const auto as_early = open_sigmf_writer(meta_file, head);
    growing->write(0, numbered_rows(0, 300));
    const auto being_written = HasSubstr("it is being written, by this or another program");
    EXPECT_THAT(error_of([&] { open_sigmf_writer(meta_file, head); }), being_written);
    EXPECT_THAT(error_of([&] { as_early->write(0, numbered_rows(0, 10)); }), being_written);
    growing->commit();
    EXPECT_EQ(read_rows(*open_sigmf_reader(meta_file)).at(0).values.size(), 600U);
    open_sigmf_writer(meta_file, head)->commit();
    EXPECT_THAT(read_rows(*open_sigmf_reader(meta_file)), IsEmpty());
}

TEST_F(Sigmf, AfterAFailureWhatWasWrittenStays) {
    auto writer = open_sigmf_writer(meta_file, recording_head(two, 1000));
    writer->write(0, numbered_rows(0, 300));
    const std::vector<double> too_large{1e300, 0};
    EXPECT_THAT(error_of([&] { writer->write(300, too_large); }), HasSubstr("float32"));
    EXPECT_NE(error_of([&] { writer->commit(); }), "");
    writer.reset();
    const auto read = read_rows(*open_sigmf_reader(meta_file));
    ASSERT_THAT(read, SizeIs(1));
    EXPECT_EQ(read[0].values, numbered_rows(0, 300));
}

/// Runs in a process of its own, because the limit on the size of files cannot be raised again.
TEST_F(Sigmf, AFullDiskLeavesWholeSamples) {
    constexpr std::size_t limit = 100'001;  // bytes; no whole number of samples
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit small{limit, limit};
        setrlimit(RLIMIT_FSIZE, &small);
        auto writer = open_sigmf_writer(meta_file, recording_head({"a", "b", "c"}, 1000));
        const std::vector<double> rows(300, 0.5);
        std::string error;
        for (std::int64_t first = 0; first < 100'000 && error.empty(); first += 100) {
            error = error_of([&] { writer->write(first, rows); });
        }
        writer.reset();
        _exit(error.find("File too large") != std::string::npos ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0) << "no error, or another one";
    EXPECT_EQ(fs::file_size(data_file), limit / 12 * 12);
    const auto read = read_rows(*open_sigmf_reader(meta_file));
    ASSERT_THAT(read, SizeIs(1));
    EXPECT_EQ(read[0].values, std::vector<double>(limit / 12 * 3, 0.5));
}

TEST_F(Sigmf, AFileThatVanishesIsAnError) {
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 1000));
    writer->write(0, numbered_rows(0, 1000));
    fs::remove(data_file);
    EXPECT_THAT(error_of([&] { writer->write(1000, numbered_rows(1000, 1000)); }),
                testing::AllOf(HasSubstr(data_file), HasSubstr("No such file")));
}

TEST_F(Sigmf, GapsWithoutEndEndTheRecording) {
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 1e9));
    std::int64_t gaps = 0;
    const std::string error = error_of([&] {
        for (; gaps < 20'000; ++gaps) {
            writer->write(10 * gaps, numbered_rows(10 * gaps, 1));
        }
    });
    EXPECT_THAT(error, HasSubstr("gaps"));
    EXPECT_EQ(gaps, 10'000);
    EXPECT_EQ(writer->kept().rows, gaps);
    EXPECT_EQ(fs::file_size(data_file), static_cast<std::uintmax_t>(gaps) * 2 * sizeof(float));
}

TEST_F(Sigmf, HalfASampleAtTheEndIsLeftOutWithAWarning) {
    const auto writer = open_sigmf_writer(meta_file, recording_head(two, 1000));
    writer->write(0, numbered_rows(0, 10));
    writer->commit();
    fs::resize_file(data_file, 10 * 8 - 3);
    std::string warning;
    const auto read = read_rows(*open_sigmf_reader(
        meta_file, {.sample_rate_hz = {}, .warn = [&](const std::string& text) { warning = text; }}));
    ASSERT_THAT(read, SizeIs(1));
    EXPECT_THAT(read[0].values, SizeIs(9 * 2));
    EXPECT_THAT(warning, HasSubstr("the last 5 bytes are left out: they are no whole row of 8 bytes"));
}

TEST_F(Sigmf, ReadsRecordingsOfOthers) {
    write_text(meta_file, R"({"global": {"core:datatype": "rf32_le", "core:sample_rate": 48000,
                                         "core:version": "1.0.0"}, "captures": [], "annotations": []})");
    const std::array<float, 3> samples{1, 2, 3};
    write_text(data_file, std::string(reinterpret_cast<const char*>(samples.data()), sizeof samples));
    const auto reader = open_sigmf_reader(meta_file);
    EXPECT_THAT(reader->head().columns, SizeIs(1));
    const auto read = read_rows(*reader);
    ASSERT_THAT(read, SizeIs(1));
    EXPECT_EQ(read[0].first, 0);
    EXPECT_THAT(read[0].values, testing::ElementsAre(1, 2, 3));
}

class SigmfOfOthers : public Sigmf {
protected:
    /// Reads 20 float32 from 0 on with these metadata.
    std::vector<RecordedRows> read(const std::string& global, const std::string& captures,
                                   const ReadOptions& options = {}) {
        std::vector<float> samples(20);
        std::iota(samples.begin(), samples.end(), 0.0F);
        write_text(data_file, std::string(reinterpret_cast<const char*>(samples.data()), 80));
        write_text(meta_file, R"({"global": {"core:datatype": "rf32_le")" + global + R"(}, "captures": [)" +
                                  captures + R"(], "annotations": []})");
        const auto reader = open_sigmf_reader(meta_file, options);
        rate_hz = reader->head().sample_rate_hz;
        return read_rows(*reader);
    }
    double rate_hz = 0;
    const std::string rate = R"(, "core:sample_rate": 1000)";
};

TEST_F(SigmfOfOthers, SamplesBeforeTheFirstCaptureAreNobodys) {
    std::vector<std::string> told;
    const ReadOptions telling{.sample_rate_hz = {},
                              .warn = [&](const std::string& text) { told.push_back(text); }};
    const auto rows = read(rate, R"({"core:sample_start": 5})", telling);
    ASSERT_THAT(rows, SizeIs(1));
    EXPECT_EQ(rows[0].first, 5);
    EXPECT_THAT(rows[0].values, testing::AllOf(SizeIs(15), testing::Contains(5), testing::Contains(19)));
    EXPECT_THAT(read(rate, R"({"core:sample_start": 50})", telling), testing::IsEmpty());
    EXPECT_THAT(
        told, testing::ElementsAre(HasSubstr("5 of 20 samples lie before the first capture and are left out"),
                                   HasSubstr("20 of 20 samples lie before the first capture")));
}

TEST_F(SigmfOfOthers, AnOffsetIsTheNumberOfTheFirstSample) {
    EXPECT_EQ(read(rate + R"(, "core:offset": 100)", R"({"core:sample_start": 102})").at(0).first, 102);
    EXPECT_EQ(read(rate + R"(, "core:offset": 100)", R"({"core:sample_start": 102})").at(0).values[0], 2);
    EXPECT_EQ(read(rate + R"(, "core:offset": 100)", "").at(0).first, 100);
}

TEST_F(SigmfOfOthers, HeadersAndTrailersAreNoSamples) {
    const auto rows = read(rate + R"(, "core:trailing_bytes": 12)",
                           R"({"core:sample_start": 0, "core:header_bytes": 8},
                              {"core:sample_start": 4, "core:header_bytes": 4})");
    ASSERT_THAT(rows, SizeIs(1));
    EXPECT_THAT(rows[0].values, testing::ElementsAre(2, 3, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16));
}

TEST_F(SigmfOfOthers, ARateThatIsMissingIsTheGivenOne) {
    EXPECT_THAT(read("", "", {.sample_rate_hz = 2e6, .warn = {}}), SizeIs(1));
    EXPECT_EQ(rate_hz, 2e6);
    read("", "");
    EXPECT_EQ(rate_hz, 0);
    read(rate, "", {.sample_rate_hz = 2e6, .warn = {}});
    EXPECT_EQ(rate_hz, 1000);
}

TEST_F(SigmfOfOthers, ADatasetMayHaveAnotherName) {
    write_text(folder.file("b.raw"), std::string(8, '\0'));
    EXPECT_THAT(read(rate + R"(, "core:dataset": "b.raw")", "").at(0).values, SizeIs(2));
}

TEST_F(SigmfOfOthers, SamplesWithAnotherHashAreRefused) {
    EXPECT_THAT(error_of([&] { read(rate + R"(, "core:sha512": ")" + std::string(128, '0') + '"', ""); }),
                HasSubstr("core:sha512: the samples in a.sigmf-data are not those"));
}

TEST_F(SigmfOfOthers, MetadataWithoutAPartAreRefused) {
    write_text(data_file, std::string(8, '\0'));
    for (const char* text : {"{}", "[]", R"({"captures": []})"}) {
        write_text(meta_file, text);
        EXPECT_THAT(error_of([&] { open_sigmf_reader(meta_file); }), HasSubstr("global: found nothing"))
            << text;
    }
}

TEST_F(SigmfOfOthers, OnceStoppedNoHashIsComparedAndNoSampleIsRead) {
    const std::string of_others = rate + R"(, "core:sha512": ")" + std::string(128, '0') + '"';
    std::atomic<bool> stop = true;
    ReadOptions options;
    options.stop = &stop;
    EXPECT_THAT(read(of_others, "", options), testing::IsEmpty());
    stop = false;
    EXPECT_THROW(read(of_others, "", options), std::runtime_error);
}

TEST_F(Sigmf, AnArchiveThatIsNoneIsRefusedByName) {
    const std::string archive = folder.file("a.sigmf");
    for (const std::string& text :
         {std::string(), std::string(512, 'x'), std::string(700, '\0'), std::string(5, 'x')}) {
        write_text(archive, text);
        EXPECT_THAT(error_of([&] { open_sigmf_archive_reader(archive); }), HasSubstr(archive));
    }
}

TEST_F(Sigmf, MetadataThatAreNoneAreRefusedByName) {
    write_text(data_file, std::string(80, '\0'));
    const std::string global =
        R"("core:datatype": "rf32_le", "core:version": "1.0.0", "core:sample_rate": 1e6)";
    const auto with = [](const std::string& g, const std::string& captures) {
        return R"({"global": {)" + g + R"(}, "captures": )" + captures + R"(, "annotations": []})";
    };
    const auto capture = [](const std::string& start, const std::string& index) {
        return R"({"core:sample_start": )" + start + R"(, "core:global_index": )" + index + "}";
    };
    const std::vector<std::string> wrong{
        "",
        "[]",
        "{}",
        "null",
        R"({"global": 3, "captures": []})",
        R"({"global": {}})",
        std::string(100'000, '['),
        with(R"("core:datatype": "xf32_le", "core:sample_rate": 1e6)", "[]"),
        with(R"("core:datatype": "rf32", "core:sample_rate": 1e6)", "[]"),
        with(R"("core:datatype": "ri8_le", "core:sample_rate": 1e6)", "[]"),
        with(global + R"(, "core:metadata_only": true)", "[]"),
        with(global + R"(, "core:dataset": "../a.sigmf-data")", "[]"),
        with(global + R"(, "core:sha512": "00")", "[]"),
        with(R"("core:datatype": 5, "core:sample_rate": 1e6)", "[]"),
        with(R"("core:datatype": "rf32_le", "core:sample_rate": -1)", "[]"),
        with(global + R"(, "core:num_channels": 0)", "[]"),
        with(global + R"(, "core:num_channels": 1e9)", "[]"),
        with(global + R"(, "core:num_channels": "2")", "[]"),
        with(global + R"(, "core:offset": 5)", R"([{"core:sample_start": 4}])"),
        with(global + R"(, "hertzline:columns": 5)", "[]"),
        with(global + R"(, "hertzline:columns": [{"name": 5}])", "[]"),
        with(global, "{}"),
        with(global, "[{}]"),
        with(global, "[3]"),
        with(global, "[" + capture("-1", "0") + "]"),
        with(global, "[" + capture("0.5", "0") + "]"),
        with(global, "[" + capture("0", "99999999999999999999") + "]"),
        with(global, "[" + capture("5", "5") + "," + capture("0", "9") + "]"),
        with(global, "[" + capture("0", "0") + "," + capture("5", "3") + "]"),
        with(global, R"([{"core:sample_start": 0, "core:header_bytes": -8}])"),
    };
    for (const std::string& text : wrong) {
        write_text(meta_file, text);
        EXPECT_THAT(error_of([&] { read_rows(*open_sigmf_reader(meta_file)); }), HasSubstr(meta_file))
            << text.substr(0, 200);
    }
    // a killed program may leave captures beyond the data
    write_text(meta_file, with(global, "[" + capture("0", "0") + "," + capture("50", "90") + "]"));
    EXPECT_THAT(read_rows(*open_sigmf_reader(meta_file)), SizeIs(1));
}

}  // namespace
}  // namespace hertzline::test
