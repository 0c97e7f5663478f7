#include "hertzline/scene.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/scene_key.hpp"
#include "tests/support/list_values.hpp"

namespace hertzline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

std::vector<std::string> faulty_keys(const Scene& scene) {
    std::vector<std::string> keys;
    for (const Fault& fault : validate(scene)) {
        keys.push_back(fault.key);
    }
    return keys;
}

// Returns the faults of the default scene with one change.
std::vector<Fault> faults_after(const std::function<void(Scene&)>& change) {
    Scene scene;
    change(scene);
    return validate(scene);
}

TEST(Scene, DefaultsAreThePapersValues) {
    const Scene scene;
    EXPECT_EQ(scene.drive.material, "steel");
    EXPECT_EQ(scene.drive.frequency_hz, 73e3);
    EXPECT_EQ(scene.drive.cycles, 25);
    EXPECT_EQ(scene.drive.amplitude_m, 3e-6);
    EXPECT_EQ(scene.drive.envelope, Envelope::hann);
    EXPECT_EQ(scene.drive.taper, 0.2);
    EXPECT_EQ(scene.drive.repetition_hz, 0);
    EXPECT_EQ(scene.chain.material, "aluminium");
    EXPECT_EQ(scene.chain.spheres, 6);
    EXPECT_EQ(scene.chain.diameter_m, 1e-3);
    EXPECT_EQ(scene.chain.damping_kg_per_s, 0.32);
    EXPECT_EQ(scene.chain.preload_n, 0.1);
    EXPECT_EQ(scene.chain.tension, Tension::allowed);
    EXPECT_EQ(scene.end.kind, EndKind::plate);
    EXPECT_EQ(scene.end.material, "vitreous_carbon");
    EXPECT_EQ(scene.end.radius_m, 5e-3);
    EXPECT_EQ(scene.end.thickness_m, 0.5e-3);
    EXPECT_EQ(scene.end.stiffness_n_per_m, std::nullopt);
    EXPECT_EQ(scene.end.preload, PlatePreload::balanced);
    EXPECT_EQ(scene.medium.material, "water");
    EXPECT_EQ(scene.numerics, Numerics{});
    EXPECT_EQ(scene.output.sample_rate_hz, 10e6);
    EXPECT_EQ(scene.output.duration_s, 500e-6);
    EXPECT_EQ(scene.output.frame_samples, 1024);
    EXPECT_THAT(scene.materials, IsEmpty());
}

TEST(Scene, DefaultsAreValid) {
    EXPECT_THAT(validate(Scene{}), IsEmpty());
}

/// The key itself, or the first entry of a list.
SceneKey first_of(const SceneKey& key) {
    return key.is_list() ? first_of(key.entry(0)) : key;
}

TEST(Scene, NoNumberMayBeInfiniteOrNotANumber) {
    for (const SceneKey& key : scene_keys()) {
        if (key.kind != ValueKind::number) {
            continue;
        }
        for (const double value : {nan, inf, -inf, 1e300, -1e300}) {
            Scene scene;
            EXPECT_TRUE(key.set(scene, test::filled_with(key, value)));
            EXPECT_THAT(faulty_keys(scene), testing::Contains(first_of(key).name)) << value;
        }
    }
}

struct Bound {
    const char* key;
    double allowed;
    double refused;
    std::function<void(Scene&, double)> set;
};

TEST(Scene, EachBoundIsWhereItShouldBe) {
    const double above_one = std::nextafter(1, 2);
    const std::vector<Bound> bounds{
        {"drive.frequency_hz", 1e-3, 0, [](Scene& s, double x) { s.drive.frequency_hz = x; }},
        {"drive.cycles", 1e-3, 0, [](Scene& s, double x) { s.drive.cycles = x; }},
        {"drive.amplitude_m", 0, -1e-9, [](Scene& s, double x) { s.drive.amplitude_m = x; }},
        {"drive.taper", 0, -1e-9, [](Scene& s, double x) { s.drive.taper = x; }},
        {"drive.taper", 1, above_one, [](Scene& s, double x) { s.drive.taper = x; }},
        {"drive.repetition_hz", 0, -1e-9, [](Scene& s, double x) { s.drive.repetition_hz = x; }},
        {"drive.repetition_hz", 73e3 / 25, 73e3 / 24.99,
         [](Scene& s, double x) { s.drive.repetition_hz = x; }},
        {"chain.spheres", 1, 0, [](Scene& s, double x) { s.chain.spheres = static_cast<std::int64_t>(x); }},
        {"chain.spheres", 1e7, 1e7 + 1,
         [](Scene& s, double x) { s.chain.spheres = static_cast<std::int64_t>(x); }},
        {"chain.diameter_m", 1e-9, 0, [](Scene& s, double x) { s.chain.diameter_m = x; }},
        {"chain.damping_kg_per_s", 0, -1e-9, [](Scene& s, double x) { s.chain.damping_kg_per_s = x; }},
        {"chain.damping_time_s", 0, -1e-9, [](Scene& s, double x) { s.chain.damping_time_s = x; }},
        {"chain.damping_time_s", 1, above_one, [](Scene& s, double x) { s.chain.damping_time_s = x; }},
        {"chain.damping_alpha", 0, -1e-9, [](Scene& s, double x) { s.chain.damping_alpha = x; }},
        {"chain.damping_alpha", 10, 10.1, [](Scene& s, double x) { s.chain.damping_alpha = x; }},
        {"chain.preload_n", 0, -1e-9, [](Scene& s, double x) { s.chain.preload_n = x; }},
        {"end.radius_m", 1e-9, 0, [](Scene& s, double x) { s.end.radius_m = x; }},
        {"end.thickness_m", 1e-9, 0, [](Scene& s, double x) { s.end.thickness_m = x; }},
        {"end.stiffness_n_per_m", 0, -1e-9, [](Scene& s, double x) { s.end.stiffness_n_per_m = x; }},
        {"numerics.step_s", 1e-15, 0, [](Scene& s, double x) { s.numerics.step_s = x; }},
        {"numerics.accuracy", 1e-15, 0, [](Scene& s, double x) { s.numerics.accuracy = x; }},
        {"numerics.accuracy", 0.1, 0.11, [](Scene& s, double x) { s.numerics.accuracy = x; }},
        {"numerics.rest_tolerance", 0, -1e-9, [](Scene& s, double x) { s.numerics.rest_tolerance = x; }},
        {"numerics.rest_tolerance", 0.01, 0.011, [](Scene& s, double x) { s.numerics.rest_tolerance = x; }},
        {"output.sample_rate_hz", 1e-3, 0, [](Scene& s, double x) { s.output.sample_rate_hz = x; }},
        {"output.sample_rate_hz", 1e12, 1.1e12, [](Scene& s, double x) { s.output.sample_rate_hz = x; }},
        {"output.duration_s", 1e-12, 0, [](Scene& s, double x) { s.output.duration_s = x; }},
        {"output.frame_samples", 1, 0,
         [](Scene& s, double x) { s.output.frame_samples = static_cast<std::int64_t>(x); }},
        {"output.frame_samples", 1048576, 1048577,
         [](Scene& s, double x) { s.output.frame_samples = static_cast<std::int64_t>(x); }},
    };
    for (const Bound& bound : bounds) {
        EXPECT_THAT(faults_after([&](Scene& scene) { bound.set(scene, bound.allowed); }), IsEmpty())
            << bound.key;
        Scene scene;
        bound.set(scene, bound.refused);
        EXPECT_THAT(faulty_keys(scene), ElementsAre(bound.key)) << bound.refused;
    }
}

TEST(Scene, ALawOfDampingNeedsItsCoefficientAndASeries) {
    const auto faults_with = [](DampingLaw law, std::optional<double> time_s, std::optional<double> alpha,
                                std::optional<Integrator> integrator) {
        Scene scene;
        scene.chain.damping_law = law;
        scene.chain.damping_time_s = time_s;
        scene.chain.damping_alpha = alpha;
        scene.numerics.integrator = integrator;
        return validate(scene);
    };
    const auto grid = Integrator::chin4a;
    const auto series = Integrator::taylor8;
    EXPECT_THAT(faults_with(DampingLaw::dashpot, {}, {}, grid), IsEmpty());
    EXPECT_THAT(faults_with(DampingLaw::dashpot, 1e-6, 0.1, grid), IsEmpty());
    EXPECT_THAT(faults_with(DampingLaw::kuwabara_kono, 1e-6, {}, series), IsEmpty());
    EXPECT_THAT(faults_with(DampingLaw::kuwabara_kono, 0.0, {}, {}), IsEmpty());
    EXPECT_THAT(faults_with(DampingLaw::tsuji, {}, 0.1, {}), IsEmpty());

    const auto no_time = faults_with(DampingLaw::kuwabara_kono, {}, 0.1, {});
    ASSERT_EQ(no_time.size(), 1);
    EXPECT_EQ(no_time[0].key, "chain.damping_time_s");
    EXPECT_THAT(no_time[0].found, testing::HasSubstr("kuwabara_kono"));
    const auto no_alpha = faults_with(DampingLaw::tsuji, 1e-6, {}, Integrator::leapfrog);
    ASSERT_EQ(no_alpha.size(), 2);
    EXPECT_EQ(no_alpha[0].key, "chain.damping_alpha");
    EXPECT_EQ(no_alpha[1].key, "numerics.integrator");
    EXPECT_THAT(no_alpha[1].found, testing::HasSubstr("leapfrog"));
    EXPECT_THAT(no_alpha[1].allowed, testing::HasSubstr("taylor8"));
}

TEST(Scene, AFaultTellsWhatWasFoundAndWhatIsAllowed) {
    const auto faults = faults_after([](Scene& scene) { scene.chain.spheres = -3; });
    ASSERT_EQ(faults.size(), 1);
    EXPECT_EQ(faults[0].key, "chain.spheres");
    EXPECT_EQ(faults[0].found, "-3");
    EXPECT_EQ(faults[0].allowed, "an integer from 1 to 10000000");
}

TEST(Scene, AllFaultsAreListedAtOnce) {
    Scene scene;
    scene.drive.frequency_hz = -1;
    scene.chain.spheres = 0;
    scene.chain.material = "cheese";
    scene.end.thickness_m = nan;
    scene.medium.material = "steel";
    scene.numerics.step_s = 1e-9;
    scene.numerics.accuracy = 1e-4;
    scene.materials["glass"] = Solid{70e9, 0.5, 0};
    EXPECT_THAT(faulty_keys(scene),
                ElementsAre("drive.frequency_hz", "chain.material", "chain.spheres", "end.thickness_m",
                            "medium.material", "numerics.accuracy", "materials.glass.poissons_ratio",
                            "materials.glass.density_kg_per_m3"));
}

TEST(Scene, BurstsMayNotOverlap) {
    const auto faults = faults_after([](Scene& scene) { scene.drive.repetition_hz = 5000; });
    ASSERT_EQ(faults.size(), 1);
    EXPECT_THAT(faults[0].allowed, HasSubstr("2920 Hz"));
}

TEST(Scene, AnUnknownMaterialBringsTheNamesAndTheNearestOne) {
    const auto faults = faults_after([](Scene& scene) { scene.chain.material = "aluminum"; });
    ASSERT_EQ(faults.size(), 1);
    EXPECT_EQ(faults[0].found, "\"aluminum\"");
    EXPECT_THAT(faults[0].allowed, HasSubstr("pyrex, vitreous_carbon"));
    EXPECT_THAT(faults[0].allowed, HasSubstr("did you mean 'aluminium'?"));
    EXPECT_THAT(faults[0].allowed, testing::Not(HasSubstr("water")));
}

TEST(Scene, BodiesAreSolidsAndTheMediumIsAFluid) {
    Scene scene;
    scene.drive.material = "water";
    scene.chain.material = "water";
    scene.end.material = "water";
    scene.medium.material = "steel";
    EXPECT_THAT(faulty_keys(scene),
                ElementsAre("drive.material", "chain.material", "end.material", "medium.material"));
}

TEST(Scene, OwnMaterialsAreChecked) {
    const auto keys_of = [](const Material& material) {
        Scene scene;
        scene.materials["mine"] = material;
        return faulty_keys(scene);
    };
    EXPECT_THAT(keys_of(Solid{1e9, 0, 1000}), IsEmpty());
    EXPECT_THAT(keys_of(Fluid{1000, 1500}), IsEmpty());
    EXPECT_THAT(keys_of(Solid{0, -1, 0}),
                ElementsAre("materials.mine.youngs_modulus_pa", "materials.mine.poissons_ratio",
                            "materials.mine.density_kg_per_m3"));
    EXPECT_THAT(keys_of(Solid{inf, 0.5, nan}).size(), 3);
    EXPECT_THAT(keys_of(Fluid{0, -1}),
                ElementsAre("materials.mine.density_kg_per_m3", "materials.mine.sound_speed_m_per_s"));
}

TEST(Scene, NamesOfOwnMaterialsArePlain) {
    for (const char* name : {"", "a b", "a.b", "caf\xC3\xA9", "\"", "a\nb"}) {
        Scene scene;
        scene.materials[name] = Fluid{1000, 1500};
        EXPECT_EQ(validate(scene).size(), 1) << name;
    }
    Scene scene;
    scene.materials[std::string(64, 'x')] = Fluid{1000, 1500};
    EXPECT_THAT(validate(scene), IsEmpty());
    scene.materials[std::string(65, 'x')] = Fluid{1000, 1500};
    EXPECT_EQ(validate(scene).size(), 1);
}

TEST(Scene, AnImpossibleChoiceIsAFault) {
    Scene scene;
    scene.end.kind = static_cast<EndKind>(7);
    EXPECT_THAT(faulty_keys(scene), ElementsAre("end.kind"));
}

TEST(Scene, OwnMaterialsHideBuiltInOnes) {
    Scene scene;
    EXPECT_EQ(std::get<Solid>(*find_material(scene, "steel")).youngs_modulus_pa, 201e9);
    EXPECT_EQ(find_material(scene, "unobtainium"), nullptr);
    EXPECT_THROW(solid_of(scene, "unobtainium"), std::out_of_range);
    EXPECT_THROW(solid_of(scene, "water"), std::out_of_range);
    scene.materials["steel"] = Solid{190e9, 0.3, 7900};
    EXPECT_EQ(std::get<Solid>(*find_material(scene, "steel")).youngs_modulus_pa, 190e9);
    scene.materials["steel"] = Fluid{1000, 1500};
    EXPECT_THAT(faulty_keys(scene), ElementsAre("drive.material"));
}

TEST(Scene, AModalPlateNeedsASeries) {
    Scene scene;
    scene.end.model = PlateModel::modal;
    EXPECT_THAT(validate(scene), IsEmpty());
    for (const Method& row : methods) {
        scene.numerics.integrator = row.integrator;
        const std::vector<Fault> faults = validate(scene);
        if (row.family == Family::series) {
            EXPECT_THAT(faults, IsEmpty()) << row.word;
            continue;
        }
        ASSERT_THAT(faults, SizeIs(1)) << row.word;
        EXPECT_EQ(faults[0].message(), "numerics.integrator: found \"" + std::string(row.word) +
                                           "\" with end.model = \"modal\", allowed: \"taylor8\" or "
                                           "\"taylor12\", the series");
    }
}

TEST(Scene, NothingButItsModesSaysWhatAModalPlateIs) {
    Scene scene;
    scene.end.model = PlateModel::modal;
    scene.end.kind = EndKind::wall;
    scene.end.stiffness_n_per_m = 1e5;
    scene.end.preload = PlatePreload::as_printed;
    scene.output.sample_rate_hz = 1e12;
    scene.output.hydrophone_m = 0.1;
    EXPECT_THAT(faulty_keys(scene),
                ElementsAre("end.model", "end.stiffness_n_per_m", "end.preload", "output.hydrophone_m"));
}

}  // namespace
}  // namespace hertzline
