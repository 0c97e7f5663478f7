// hertzline field: its table, and refused requests.

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recordings/formats/table.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/recorded_columns.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

namespace {

using testing::HasSubstr;

const Words quick{"wet-vitreous-carbon", "--set", "drive.cycles=3", "--set", "output.duration_s=100us"};

Words with_quick(Words words, const Words& more) {
    words.insert(words.begin() + 1, quick.begin(), quick.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST(Field, ATableHasARowForEachPointAndTheNumbersOfARun) {
    const TemporaryFolder folder;
    const std::string csv = folder.file("field.csv");
    const Outcome outcome =
        hertzline(with_quick({"field", "--plane", "x=0,4mm,z=5mm..10mm:2", "-o", csv, "--json"}, {}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["points"], 4);
    EXPECT_EQ(outcome.json()["at_m"], nlohmann::json({0.0, 0.0, 0.005}));
    EXPECT_FALSE(outcome.json().contains("near_focus_m")) << "there is no array";
    std::istringstream lines(contents(csv));
    std::string line;
    std::getline(lines, line);
    EXPECT_THAT(line, testing::StartsWith("point,x_m,y_m,z_m,status,peak_pa,rms_pa,harmonic_1_pa,"));
    std::vector<std::vector<std::string>> rows;
    while (std::getline(lines, line)) {
        std::istringstream cells(line);
        rows.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');) {
            rows.back().push_back(cell);
        }
    }
    ASSERT_EQ(rows.size(), 4U);
    EXPECT_EQ(rows[1][1] + ' ' + rows[1][3], "0.004 0.005");
    EXPECT_EQ(rows[2][1] + ' ' + rows[2][3], "0 0.01");
    const Outcome on_axis = hertzline(with_quick({"run", "--json"}, {}));  // the hydrophone is at 10 mm
    EXPECT_NEAR(std::stod(rows[2][5]), on_axis.json()["p_axis"]["peak_p_axis_pa"].get<double>(), 1);
}

// tests/readers/read_field.m compares them with a run's.
TEST(Field, WaveformsAreKeptBesideTheTable) {
    const TemporaryFolder folder;
    const std::string field = folder.file("field.h5");
    ASSERT_EQ(
        hertzline(with_quick({"field", "--plane", "x=0,4mm,z=5mm", "--waveforms", "-o", field}, {})).status,
        0);
    EXPECT_GT(std::filesystem::file_size(field), 2 * 1001 * sizeof(float));
    EXPECT_EQ(recordings::read_table(field, "points").provenance["plane"], "x=0,0.004,y=0,z=0.005");
}

TEST(Field, WaveformsThatTheDiskCannotHoldAreRefusedAtOnce) {
    const TemporaryFolder folder;
    const Outcome outcome =
        hertzline(with_quick({"field", "--plane", "x=-8mm..8mm:1000,z=1mm..31mm:1000", "--set",
                              "output.sample_rate_hz=10GHz", "--waveforms", "-o", folder.file("field.h5")},
                             {}));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, testing::AllOf(HasSubstr("TiB of disk"), HasSubstr("is free")));
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("")));
}

TEST(Field, ThatTheMemoryOrASpectrumCannotHoldIsRefusedAtOnce) {
    const TemporaryFolder folder;
    const auto refusal = [&](const Words& settings) {
        const Words plane{"field", "--plane", "x=-8mm..8mm:48,z=5mm", "--jobs",
                          "64",    "-o",      folder.file("f.csv")};
        const Outcome outcome = hertzline(with_quick(plane, settings));
        EXPECT_EQ(outcome.status, 1);
        return outcome.err;
    };
    EXPECT_THAT(
        refusal({"--set", "output.sample_rate_hz=1e12"}),
        testing::AllOf(HasSubstr("a field with 64 jobs"), HasSubstr("of memory"), HasSubstr("fewer --jobs")));
    EXPECT_THAT(refusal({"--set", "output.sample_rate_hz=1e12", "--set", "output.duration_s=1"}),
                HasSubstr("the longest record of a spectrum"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("")));
}

TEST(Field, ItsRowsHaveTheStatusOfTheMotion) {
    const TemporaryFolder folder;
    const std::string csv = folder.file("field.csv");
    const Outcome outcome = hertzline(with_quick({"field", "--plane", "z=5mm,10mm", "-o", csv, "--json"},
                                                 {"--set", "numerics.accuracy=1e-12"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["status"], "inaccurate");
    EXPECT_THAT(contents(csv),
                testing::AllOf(HasSubstr(",0.005,inaccurate,"), HasSubstr(",0.01,inaccurate,")));
}

TEST(Field, SaysWhereTheSoundHasNotArrived) {
    const TemporaryFolder folder;
    const Outcome outcome =
        hertzline(with_quick({"field", "--plane", "z=10mm,1m", "-o", folder.file("field.csv")}, {}));
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("before the sound can reach 1 of 2 points"));
}

TEST(Field, RefusesWhatHasNoSoundAndWrongPlanes) {
    const TemporaryFolder folder;
    const std::string csv = folder.file("field.csv");
    const Outcome lumped = hertzline({"field", "paper-vitreous-carbon", "--plane", "z=0", "-o", csv});
    EXPECT_EQ(lumped.status, 2);
    EXPECT_THAT(lumped.err, HasSubstr("end.model"));
    const Outcome behind = hertzline(with_quick({"field", "--plane", "z=-1mm", "-o", csv}, {}));
    EXPECT_EQ(behind.status, 2);
    EXPECT_THAT(behind.err, HasSubstr("--plane"));
    const Outcome samples = hertzline(with_quick({"field", "--plane", "z=0", "--waveforms", "-o", csv}, {}));
    EXPECT_EQ(samples.status, 2);
    EXPECT_THAT(samples.err, HasSubstr("-o"));
    EXPECT_FALSE(std::filesystem::exists(csv));
}

}  // namespace

}  // namespace hertzline::test
