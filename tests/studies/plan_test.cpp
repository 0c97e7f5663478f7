#include "studies/plan.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"
#include "tests/support/error_of.hpp"

namespace hertzline::test {

using namespace studies;

namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Scene base() {
    return parse_scene("[materials.mine]\nyoungs_modulus_pa = 5e9\npoissons_ratio = 0.3\ndensity = 1200\n",
                       "base")
        ->scene;
}

/// Returns the faults of a request, a line each.
std::string faults_of(const PlanRequest& request) {
    const auto plan = SweepPlan::make(base(), request);
    std::string text;
    if (!plan) {
        for (const Fault& fault : plan.error()) {
            text += fault.message() + '\n';
        }
    }
    return text;
}

std::string faults_of(const std::string& vary) {
    return faults_of(PlanRequest{{vary}, "", "", std::nullopt});
}

SweepPlan plan_of(const PlanRequest& request) {
    auto plan = SweepPlan::make(base(), request);
    EXPECT_TRUE(plan) << faults_of(request);
    return *std::move(plan);
}

SweepPlan grid_of(const std::vector<std::string>& vary) {
    return plan_of({vary, "", "", std::nullopt});
}

std::vector<double> numbers_of(const SweepPlan& plan) {
    std::vector<double> numbers;
    for (std::int64_t point = 0; point < plan.size(); ++point) {
        numbers.push_back(std::get<double>(plan.values(point).front()));
    }
    return numbers;
}

TEST(FirstSettings, AreTheFirstValuesAsTheyStand) {
    const auto of_vary = [](const std::string& option) {
        return first_settings({{option}, "", "", std::nullopt});
    };
    EXPECT_THAT(of_vary("chain.spheres=3,5"), ElementsAre("chain.spheres=3"));
    EXPECT_THAT(of_vary("chain.preload_n=10mN..1N:log:4"), ElementsAre("chain.preload_n=10mN"));
    EXPECT_THAT(of_vary("drive.file=../a.npy,../b.npy"), ElementsAre("drive.file=../a.npy"));
    EXPECT_THAT(of_vary("chain.preload_n = .1 .. 1 : 3"), ElementsAre("chain.preload_n=0.1"));
    EXPECT_THAT(of_vary(".."), ElementsAre("..="));
    EXPECT_THAT(of_vary(""), ElementsAre("="));
    EXPECT_THAT(first_settings({{},
                                "\xEF\xBB\xBF"
                                "a.b, \"c.d\"\n\n1,\"x\"\n2,y\n",
                                "",
                                std::nullopt}),
                ElementsAre("a.b=1", "c.d=x"));
    EXPECT_THAT(first_settings({{}, "a.b\n", "", std::nullopt}), IsEmpty());
}

TEST(SweepPlan, ARangeHasBothEndsAndEvenSteps) {
    EXPECT_THAT(numbers_of(grid_of({"chain.preload_n=0.25..1.25:5"})), ElementsAre(0.25, 0.5, 0.75, 1, 1.25));
    const auto numbers = numbers_of(grid_of({"chain.preload_n = 0.01 .. 10 : log : 4"}));
    EXPECT_EQ(numbers.front(), 0.01);
    EXPECT_EQ(numbers.back(), 10);
    EXPECT_NEAR(numbers[1], 0.1, 1e-16);
    EXPECT_NEAR(numbers[2], 1, 1e-15);
}

TEST(SweepPlan, TheLastKeyVariesFastest) {
    const SweepPlan plan = grid_of({"end.material=pyrex,mine", "chain.spheres=2..4:3"});
    EXPECT_EQ(plan.size(), 6);
    EXPECT_EQ(plan.text(), "2 x 3 points of end.material, chain.spheres");
    std::vector<std::string> names;
    for (std::int64_t point = 0; point < plan.size(); ++point) {
        names.push_back(plan.name(point));
        EXPECT_THAT(validate(plan.scene(point)), IsEmpty());
    }
    EXPECT_EQ(names.front(), "point 0 (end.material=pyrex, chain.spheres=2)");
    EXPECT_EQ(names[1], "point 1 (end.material=pyrex, chain.spheres=3)");
    EXPECT_EQ(names.back(), "point 5 (end.material=mine, chain.spheres=4)");
    EXPECT_EQ(plan.scene(5).end.material, "mine");
    EXPECT_EQ(plan.scene(5).chain.spheres, 4);
}

TEST(SweepPlan, EveryKeyOfASceneVaries) {
    for (const SceneKey& key : keys_of(base())) {
        if (key.is_list()) {
            EXPECT_THAT(faults_of(key.name + "=1"),
                        HasSubstr("found a list, allowed: an entry of it, as " + key.name + "[1]"));
            continue;
        }
        const auto value = key.value(base());
        const std::string values = value                         ? value_text(*value)
                                   : key.traits.is_text          ? "any text"
                                   : key.kind == ValueKind::word ? key.words.front()
                                                                 : value_text(key.range.max);
        const SweepPlan plan = grid_of({key.name + "=" + values});
        EXPECT_EQ(value_text(*key.value(plan.scene(0))), values);
    }
    const SweepPlan plan =
        grid_of({"materials.mine.density_kg_per_m3=1000,2000", "numerics.integrator=chin4a"});
    EXPECT_EQ(std::get<Solid>(plan.scene(1).materials.at("mine")).density_kg_per_m3, 2000);
    EXPECT_EQ(plan.scene(1).numerics.integrator, Integrator::chin4a);
    EXPECT_EQ(grid_of({"numerics.step_s=1e-9,2e-9"}).scene(1).numerics.step_s, 2e-9);
}

TEST(SweepPlan, IntegersOfARangeAreRoundedAndComeOnce) {
    std::vector<std::int64_t> spheres;
    const SweepPlan plan = grid_of({"chain.spheres=1..100:log:5"});
    for (std::int64_t point = 0; point < plan.size(); ++point) {
        spheres.push_back(plan.scene(point).chain.spheres);
    }
    EXPECT_THAT(spheres, ElementsAre(1, 3, 10, 32, 100));
    EXPECT_THAT(faults_of("chain.spheres=1..10:log:9"), HasSubstr("twice"));
    EXPECT_THAT(faults_of("chain.spheres=1..3:5"), HasSubstr("at most one for each integer"));
}

TEST(SweepPlan, SobolFillsTheRangesEvenly) {
    const PlanRequest request{{"chain.preload_n=0..1", "end.thickness_m=1e-4..1e-2:log", "chain.spheres=1..4",
                               "end.material=pyrex,acrylic"},
                              "",
                              "",
                              256};
    const SweepPlan plan = plan_of(request);
    std::array<int, 4> quarters{};
    std::array<int, 2> decades{};
    std::array<int, 4> spheres{};
    int pyrex = 0;
    for (std::int64_t point = 0; point < plan.size(); ++point) {
        const Scene scene = plan.scene(point);
        ++quarters.at(static_cast<std::size_t>(scene.chain.preload_n * 4));
        ++decades.at(scene.end.thickness_m < 1e-3 ? 0 : 1);
        ++spheres.at(static_cast<std::size_t>(scene.chain.spheres - 1));
        pyrex += scene.end.material == "pyrex" ? 1 : 0;
    }
    for (const int count : quarters) {
        EXPECT_NEAR(count, 64, 1);  // far more even than chance: +-7
    }
    EXPECT_NEAR(decades[0], 128, 1);
    for (const int count : spheres) {
        EXPECT_NEAR(count, 64, 1);
    }
    EXPECT_NEAR(pyrex, 128, 1);
    PlanRequest longer = request;
    longer.sobol = 1000;
    EXPECT_EQ(plan_of(longer).name(200), plan.name(200));  // a point depends on its number alone
}

TEST(SweepPlan, AListOfPointsIsTakenAsItIs) {
    const SweepPlan plan =
        plan_of({{},
                 "\xEF\xBB\xBF"
                 "chain.preload_n, \"end.material\"\r\n0.5,pyrex\r\n\r\n 1 , \"acrylic\"\n",
                 "points.csv",
                 std::nullopt});
    EXPECT_EQ(plan.size(), 2);
    EXPECT_EQ(plan.name(1), "point 1 (chain.preload_n=1, end.material=acrylic)");
}

TEST(SweepPlan, ATableOfASweepIsAListOfTheValuesOfItsKeys) {
    const std::string table =
        "point,chain.preload_n,end.material,status,reason,peak_v_out_m_per_s\r\n"
        "7,0.5,pyrex,refused,\"no, not this\",nan\r\n8,1,acrylic,ok,,0.1\r\n";
    const auto points = parse_points(base(), table, "a.csv");
    ASSERT_TRUE(points) << fault_text(points.error());
    ASSERT_EQ(points->size(), 2U);
    EXPECT_THAT(points->values,
                ElementsAre(SceneValue(0.5), SceneValue("pyrex"), SceneValue(1.0), SceneValue("acrylic")));
    EXPECT_THAT(first_settings(table), ElementsAre("chain.preload_n=0.5", "end.material=pyrex"));
    const auto without_status = parse_points(base(), "point,chain.preload_n\n1,2\n", "a.csv");
    ASSERT_FALSE(without_status);
    EXPECT_THAT(fault_text(without_status.error()), HasSubstr("a.csv:1: found \"point\""));
    const auto short_line = parse_points(base(), "point,chain.preload_n,status\n1,2\n", "a.csv");
    ASSERT_FALSE(short_line);
    EXPECT_THAT(fault_text(short_line.error()), HasSubstr("a.csv:2: found 2 values, allowed: 1"));
}

TEST(SweepPlan, OfValuesIsThatOfTheirText) {
    const std::vector<std::pair<std::string, std::vector<SceneValue>>> axes{
        {"chain.preload_n=0.1,0.25,1", {0.1, 0.25, std::int64_t{1}}},
        {"chain.spheres=3,4", {std::int64_t{3}, std::int64_t{4}}},
        {"end.material=\"pyrex\",\"mine\"", {"pyrex", "mine"}},
        {"drive.cycles=5", {"5"}}};
    for (const auto& [text, values] : axes) {
        const auto axis = axis_of(base(), text.substr(0, text.find('=')), values);
        ASSERT_TRUE(axis) << text;
        EXPECT_EQ(axis->text(), text);
        EXPECT_EQ(axis->list, parse_axis(base(), text, Sampling::grid)->list);
    }
    const auto points =
        points_of(base(), std::vector<PointColumn>{{"chain.preload_n", {0.5, std::int64_t{1}}},
                                                   {"end.kind", {"wall", "free"}}});
    ASSERT_TRUE(points);
    EXPECT_EQ(points->text, "chain.preload_n,end.kind\n0.5,wall\n1,free\n");
    EXPECT_EQ(points->values, parse_points(base(), points->text, "")->values);
}

TEST(SweepPlan, ValuesThatAKeyDoesNotAllowAreRefused) {
    const auto faults = [](const std::string& key, const std::vector<SceneValue>& values) {
        const auto axis = axis_of(base(), key, values);
        return axis ? "" : fault_text(axis.error());
    };
    EXPECT_THAT(faults("chain.spheres", {5.0}), HasSubstr("found 5.0, allowed: an integer from 1"));
    EXPECT_THAT(faults("chain.preload_n", {-1.0, NAN}), AllOf(HasSubstr("found -1"), HasSubstr("found nan")));
    EXPECT_THAT(faults("chain.preload_n", {1.0, 2.0, std::int64_t{1}}), HasSubstr("each value once"));
    EXPECT_THAT(faults("chain.preload_n", {"x"}), HasSubstr("found \"x\""));
    EXPECT_THAT(faults("end.kind", {1.5}), HasSubstr("found 1.5, allowed: one of"));
    EXPECT_THAT(faults("chain.prelod_n", {1.0}), HasSubstr("did you mean 'chain.preload_n'?"));
    const std::vector<SceneValue> many(1000, -1.0);
    EXPECT_THAT(axis_of(base(), "chain.preload_n", many).error(), SizeIs(12));
    const auto points = points_of(base(), std::vector<PointColumn>{{"chain.preload_n", many}});
    ASSERT_FALSE(points);
    EXPECT_THAT(points.error(), SizeIs(12));
}

TEST(SweepPlan, ReadsBackFromItsJson) {
    const std::vector<PlanRequest> requests{
        {{"chain.preload_n=1e-2..1e1:log:7", "chain.spheres=1..1000000:3", "end.material=pyrex,mine"},
         "",
         "",
         {}},
        {{"chain.preload_n=0..1", "drive.envelope=hann,tukey"}, "", "", 9},
        {{}, "chain.spheres\n3\n4\n", "a.csv", {}}};
    for (const PlanRequest& request : requests) {
        const SweepPlan plan = plan_of(request);
        const SweepPlan again = SweepPlan::from_json(plan.json());
        EXPECT_EQ(again.json(), plan.json());
        EXPECT_EQ(again.base(), plan.base());
        for (std::int64_t point = 0; point < plan.size(); ++point) {
            EXPECT_EQ(again.name(point), plan.name(point));
            EXPECT_EQ(again.scene(point), plan.scene(point));
        }
    }
    EXPECT_THAT(error_of([] { SweepPlan::from_json({{"scene", 1}}); }), HasSubstr("no plan"));
}

TEST(SweepPlan, EqualPlansHaveOneText) {
    EXPECT_EQ(grid_of({"chain.preload_n=0.01..10:3:log"}).json(),
              grid_of({"chain.preload_n=0.01..10:log:3"}).json());
    EXPECT_EQ(grid_of({"chain.preload_n=0.010..10:lin:3"}).json(),
              grid_of({"chain.preload_n=1e-2..1e1:3"}).json());
}

TEST(SweepPlan, KeysThatAreNotThereAreNamed) {
    EXPECT_THAT(faults_of("chain.prelod_n=1,2"),
                AllOf(HasSubstr("--vary chain.prelod_n=1,2"), HasSubstr("did you mean 'chain.preload_n'?")));
    EXPECT_THAT(faults_of("materials.other.density_kg_per_m3=1,2"), HasSubstr("a key of the scene"));
    EXPECT_THAT(faults_of("materials.mine.sound_speed_m_per_s=1,2"), HasSubstr("a key of the scene"));
    EXPECT_THAT(faults_of("chain=1"), HasSubstr("a key of the scene"));
    EXPECT_THAT(faults_of("nonsense"), HasSubstr("KEY=FROM..TO"));
    EXPECT_THAT(faults_of("chain.preload_n=0.1:5"),
                HasSubstr("found \"0.1:5\", allowed: chain.preload_n=FROM..TO:COUNT"));
    EXPECT_THAT(faults_of("=1,2"), HasSubstr("a key of the scene"));
}

TEST(SweepPlan, ValuesThatTheKeyDoesNotAllowAreNamed) {
    EXPECT_THAT(faults_of("chain.preload_n=1,-2,x"),
                AllOf(HasSubstr("found -2, allowed: a number from 0 to 1e+09 N"), HasSubstr("found \"x\"")));
    EXPECT_THAT(faults_of("chain.preload_n=-1..1:3"), HasSubstr("found -1, allowed: a number from 0"));
    EXPECT_THAT(faults_of("chain.preload_n=0..inf:3"), HasSubstr("found inf"));
    EXPECT_THAT(faults_of("chain.spheres=1.5,2"), HasSubstr("found 1.5, allowed: an integer from 1"));
    EXPECT_THAT(faults_of("end.material=pyrx"), HasSubstr("did you mean 'pyrex'?"));
    EXPECT_THAT(faults_of("end.material=water"), HasSubstr("a fluid"));
    EXPECT_THAT(faults_of("end.kind=wal"), HasSubstr("did you mean 'wall'?"));
    EXPECT_THAT(faults_of("end.kind=1..2:2"), HasSubstr("a list of words"));
    EXPECT_THAT(faults_of("chain.preload_n=1,,2"), HasSubstr("chain.preload_n"));
    EXPECT_THAT(faults_of("chain.preload_n=1,1"), HasSubstr("each value once"));
}

TEST(SweepPlan, RangesThatAreNoneAreNamed) {
    EXPECT_THAT(faults_of("chain.preload_n=10..0.01:5"), HasSubstr("a range that goes up"));
    EXPECT_THAT(faults_of("chain.preload_n=1..1:5"), HasSubstr("a range that goes up"));
    EXPECT_THAT(faults_of("chain.preload_n=0..1:log:5"), HasSubstr("above 0, as it is logarithmic"));
    for (const char* count : {"1", "0", "-3", "2.5", "many", "1000000000000"}) {
        EXPECT_THAT(faults_of(std::string("chain.preload_n=0..1:") + count),
                    HasSubstr("a count from 2 to 100000000"));
    }
    EXPECT_THAT(faults_of("chain.preload_n=0..1"), HasSubstr("chain.preload_n=FROM..TO:COUNT[:lin|log]"));
    EXPECT_THAT(faults_of("chain.preload_n=0..1:sqrt:3"),
                HasSubstr("chain.preload_n=FROM..TO:COUNT[:lin|log]"));
    EXPECT_THAT(faults_of({{"chain.preload_n=0..1:9"}, "", "", 9}), HasSubstr("without a count"));
}

TEST(SweepPlan, TooManyPointsAreRefused) {
    EXPECT_THAT(
        faults_of({{"chain.preload_n=0..1:1000000", "end.thickness_m=1e-4..1e-3:1000000"}, "", "", {}}),
        HasSubstr("a grid of 1e+12 points, allowed: at most 100000000"));
    EXPECT_THAT(faults_of({{"chain.preload_n=0..1"}, "", "", 1'000'000'000'000}),
                HasSubstr("1000000000000 points"));
    EXPECT_THAT(faults_of({{"chain.preload_n=0..1"}, "", "", 0}), HasSubstr("0 points"));
}

TEST(SweepPlan, AllFaultsAreToldAtOnce) {
    EXPECT_THAT(
        faults_of(
            {{"chain.preload_n=2..1:3", "end.kind=x", "chain.spheres=3,4", "chain.spheres=5"}, "", "", {}}),
        AllOf(HasSubstr("goes up"), HasSubstr("end.kind"), HasSubstr("a second time")));
    EXPECT_THAT(faults_of(PlanRequest{}), HasSubstr("--vary or --points"));
    EXPECT_THAT(faults_of({{}, "", "", 4}), HasSubstr("--sobol needs --vary"));
    EXPECT_THAT(faults_of({{"chain.spheres=3"}, "chain.spheres\n4\n", "", {}}), HasSubstr("one of them"));
}

TEST(SweepPlan, FaultsOfPointsHaveTheirLines) {
    const auto of = [](const std::string& text) { return faults_of({{}, text, "p.csv", std::nullopt}); };
    EXPECT_THAT(of("chain.preload_n,chain.prelod\n1,2\n"), HasSubstr("p.csv:1: found \"chain.prelod\""));
    EXPECT_THAT(of("chain.preload_n,chain.preload_n\n1,2\n"), HasSubstr("p.csv:1: chain.preload_n"));
    EXPECT_THAT(of("chain.preload_n\n1\n-2\n1,2\nx\n"),
                AllOf(HasSubstr("p.csv:3: chain.preload_n: found -2"),
                      HasSubstr("p.csv:4: found 2 values, allowed: 1"),
                      HasSubstr("p.csv:5: chain.preload_n: found \"x\"")));
    EXPECT_THAT(of("chain.preload_n\n"), HasSubstr("p.csv: found no point"));
    EXPECT_THAT(of(std::string("chain.preload_n\n1\0002\n", 21)), HasSubstr("p.csv:2"));
    std::string many = "chain.preload_n\n";
    for (int i = 0; i < 1000; ++i) {
        many += "-1\n";
    }
    const auto plan = SweepPlan::make(base(), {{}, many, "p.csv", std::nullopt});
    ASSERT_FALSE(plan);
    EXPECT_THAT(plan.error(), SizeIs(12));
}

TEST(SweepPlan, WhatKeysSayTogetherIsForTheRowsToTell) {
    const SweepPlan plan = grid_of({"drive.repetition_hz=0,5000", "drive.cycles=25,5"});
    EXPECT_THAT(validate(plan.scene(2)), SizeIs(1));  // bursts overlap
    EXPECT_THAT(validate(plan.scene(3)), IsEmpty());
}

}  // namespace

}  // namespace hertzline::test
