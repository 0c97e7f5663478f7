#include "hertzline/studies.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/run.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/error_of.hpp"

namespace hertzline::test {
namespace {

using testing::HasSubstr;

TEST(StudyVerbs, ASweepHasTheNumbersOfRuns) {
    const Scene scene = read_scene("paper-vitreous-carbon");
    const StudyTable table = sweep(scene, {{"chain.preload_n", std::vector<double>{0.05, 0.2}},
                                           {"chain.spheres", std::vector<std::int64_t>{4, 6}}});
    const std::vector<double> peaks = table["peak_v_out_m_per_s"];
    ASSERT_EQ(peaks.size(), 4U);
    Scene second = scene;
    second.chain.preload_n = 0.05;
    second.chain.spheres = 6;  // the last key varies fastest
    // a sweep chooses its steps without pilots: equal within the accuracy, not to the last bit
    EXPECT_NEAR(peaks[1], run(second)["peak_v_out_m_per_s"], 2e-4 * peaks[1]);
    EXPECT_EQ(table["chain.preload_n"], (std::vector<double>{0.05, 0.05, 0.2, 0.2}));
    EXPECT_EQ(table.columns.front().name, "point");
}

TEST(StudyVerbs, AListOfPointsTakesTheValuesTogether) {
    const StudyTable table = sweep(Scene{},
                                   {{"chain.preload_n", std::vector<double>{0.05, 0.2}},
                                    {"drive.envelope", std::vector<std::string>{"hann", "rectangular"}}},
                                   {.waveforms = "v_out"}, SweepPoints::list);
    EXPECT_EQ(table["chain.preload_n"], (std::vector<double>{0.05, 0.2}));
    EXPECT_EQ(table.waveforms.size(), 2 * table.waveform_samples);
    EXPECT_EQ(table.waveform_samples, 5001U);
}

TEST(StudyVerbs, WaveformsHaveAllChannels) {
    Scene scene;
    scene.output.duration_s = 20e-6;
    const StudyTable table =
        sweep(scene, {{"chain.spheres", std::vector<std::int64_t>{2, 3}}}, {.waveforms = "v_chain"});
    ASSERT_EQ(table.waveform_samples, 201U);
    ASSERT_EQ(table.waveform_channels, 3U);
    ASSERT_EQ(table.waveforms.size(), 2U * 201 * 3);
    for (std::size_t point = 0; point < 2; ++point) {
        scene.chain.spheres = 2 + static_cast<std::int64_t>(point);
        scene.numerics.step_s = table["step_s"][point];
        std::vector<double> v;
        RunOptions options{.recorded = Tap::v_chain};
        options.take = [&](const Samples& block) {
            v.insert(v.end(), block[Tap::v_chain].begin(), block[Tap::v_chain].end());
            return true;
        };
        run(scene, options);
        ASSERT_EQ(v.size(), 201 * (2 + point));
        for (std::size_t i = 0; i < 201 * 3; ++i) {
            const float found = table.waveforms[point * 201 * 3 + i];
            const std::size_t sphere = i % 3;
            if (sphere < 2 + point) {
                ASSERT_EQ(found, static_cast<float>(v[i / 3 * (2 + point) + sphere]));
            } else {
                ASSERT_TRUE(std::isnan(found));
            }
        }
    }
    EXPECT_THAT(error_of([&] {
                    sweep(scene, {{"chain.preload_n", std::vector<double>{0.1}}}, {.waveforms = "v_chian"});
                }),
                HasSubstr("waveforms: found \"v_chian\", allowed: v_out, v_last, v_plate, v_chain"));
}

TEST(StudyVerbs, EveryFaultIsThrownAtOnce) {
    const std::string faults = error_of([] {
        sweep(Scene{}, {{"chain.preload", "1..2:3"}}, {.measure = {"v_nothing"}, .jobs = 0});
    });
    EXPECT_THAT(faults, HasSubstr("jobs: found 0, allowed: 1 to 1024"));
    EXPECT_THAT(faults, HasSubstr("chain.preload"));
    EXPECT_THROW(sweep(Scene{}, {{"chain.preload_n", std::vector<double>{}}}), std::invalid_argument);
    EXPECT_THAT(error_of([] {
                    optimise(Scene{}, {{"chain.preload_n", "0.1..1"}},
                             {.subject_to = {"nonsense"}, .evaluations = 0});
                }),
                testing::AllOf(HasSubstr("maximise or minimise is missing"), HasSubstr("subject_to: "),
                               HasSubstr("evaluations: found 0")));
}

TEST(StudyVerbs, ListsOfOtherLengthsRangesAndNothingAreRefusedAsPoints) {
    const std::vector<double> two{0.1, 0.2};
    const std::vector<double> one{1e-3};
    const auto error_of_list = [](const StudyKeys& keys) {
        return error_of([&] { sweep(Scene{}, keys, {}, SweepPoints::list); });
    };
    EXPECT_EQ(error_of_list({{"chain.preload_n", two}, {"end.thickness_m", one}}),
              "end.thickness_m: found 1 values, allowed: 2, as many as of chain.preload_n");
    EXPECT_EQ(error_of_list({{"chain.preload_n", one}, {"end.thickness_m", two}}),
              "end.thickness_m: found 2 values, allowed: 1, as many as of chain.preload_n");
    EXPECT_THAT(error_of_list({{"chain.preload_n", "0.1..1:2"}}),
                HasSubstr("found a range, allowed: a list"));
    EXPECT_THAT(error_of_list({{"chain.preload_n", "0.1, x"}}), HasSubstr("chain.preload_n: found \"x\""));
    const StudyTable table = sweep(
        Scene{}, {{"chain.preload_n", "0.1, 200 mN"}, {"chain.spheres", std::vector<std::int64_t>{5, 6}}}, {},
        SweepPoints::list);
    EXPECT_THAT(std::get<std::vector<double>>(table.columns.at(1).values), testing::ElementsAre(0.1, 0.2));
    EXPECT_EQ(error_of_list({}), "found no keys that vary, allowed: at least one");
    EXPECT_EQ(error_of([] {
                  sweep(Scene{}, {{"chain.preload_n", std::vector<double>{}}});
              }),
              "chain.preload_n: found no values, allowed: at least one");
    EXPECT_THAT(error_of([] {
                    sweep(Scene{}, {{"chain.preload_n=1..2:2", "0.1"}});
                }),
                HasSubstr("chain.preload_n=1..2:2"));
}

TEST(StudyVerbs, ATableHasNumbersAndWords) {
    const StudyTable table = sweep(Scene{}, {{"chain.spheres", std::vector<std::int64_t>{4}}});
    EXPECT_EQ(table["chain.spheres"], std::vector<double>{4});
    EXPECT_EQ(table.words("status"), std::vector<std::string>{"ok"});
    EXPECT_THROW(table["status"], std::out_of_range);
    EXPECT_THROW(table.words("thd_r"), std::out_of_range);
}

TEST(StudyVerbs, ASearchFindsTheBestOfItsEvaluations) {
    const SearchOutcome found = optimise(Scene{}, {{"chain.preload_n", "0.05..1:log"}},
                                         {.maximise = "peak_v_out_m_per_s", .evaluations = 40});
    const std::vector<double> peaks = found.evaluations["peak_v_out_m_per_s"];
    EXPECT_LE(peaks.size(), 40U);
    EXPECT_EQ(found.summary["best"]["peak_v_out_m_per_s"], *std::max_element(peaks.begin(), peaks.end()))
        << found.summary.dump(1);
}

TEST(StudyVerbs, AStoppedStudyHasAnEmptyTable) {
    const std::atomic<bool> stop = true;
    const StudyTable table = sweep(Scene{}, {{"chain.preload_n", "0.05..1:100"}}, {.stop = &stop});
    EXPECT_TRUE(table["chain.preload_n"].empty());
}

}  // namespace
}  // namespace hertzline::test
