#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/scene/scene_key.hpp"
#include "core/scene/toml_entries.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/list_values.hpp"

namespace hertzline {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Random allowed values.
class Randomise {
public:
    explicit Randomise(std::uint64_t seed) : bits_(seed) {}

    double unit() { return std::uniform_real_distribution<double>(0, 1)(bits_); }

    void set(Scene& scene, const SceneKey& key) {
        key.set(scene, key.is_optional && coin() ? std::nullopt : std::optional(value(scene, key)));
    }

private:
    bool coin() { return (bits_() & 1) != 0; }
    SceneValue value(const Scene& scene, const SceneKey& key) {
        if (key.is_list()) {
            std::vector<SceneValue> entries;
            constexpr std::size_t most = 16;
            for (std::size_t i = 0; i < std::min(most, key.counts.front().most); ++i) {
                entries.push_back(value(scene, key.entry(i)));
            }
            return joined(key, entries);
        }
        const Range& range = key.range;
        if (key.kind == ValueKind::integer) {
            return std::uniform_int_distribution(static_cast<std::int64_t>(range.min),
                                                 static_cast<std::int64_t>(range.max))(bits_);
        }
        if (key.kind == ValueKind::word) {
            if (key.traits.is_text) {
                return std::string(1 + bits_() % 20, 'a') + " \"x\\\u00fc\u009b\U0001f529" +
                       std::to_string(bits_());
            }
            const std::vector<std::string> words = words_of(scene, key);
            return words[bits_() % words.size()];
        }
        const double scale = std::pow(10.0, -12 * unit());  // small values as often as large ones
        const double number =
            std::clamp(range.min + (range.max - range.min) * unit() * scale, range.min, range.max);
        return range.bounds == Bounds::closed
                   ? number
                   : std::clamp(number, std::nextafter(range.min, 0), std::nextafter(range.max, 0));
    }

    std::mt19937_64 bits_;
};

/// The lists of an array as long as they have to be, or none where a scene cannot have one.
void mend_array(Scene& scene, Randomise& random) {
    Array& array = scene.array;
    const bool possible = scene.end.model == PlateModel::modal && scene.end.radius_m < 0.5 &&
                          scene.drive.kind == DriveKind::tone;
    if (!possible || array.x_m.empty()) {
        array = {.coupling = array.coupling};
        return;
    }
    const std::size_t elements = 1 + std::min<std::size_t>(array.x_m.size(), 4);
    array.x_m.resize(elements);
    array.x_m[0] = 0;
    for (std::size_t i = 1; i < elements; ++i) {
        array.x_m[i] = array.x_m[i - 1] + scene.end.radius_m * (2.1 + random.unit());
    }
    array.y_m.assign(elements, 0);
    const auto fill = [&](auto& list, const auto& entry) {
        list.assign(random.unit() < 0.3 ? 0 : random.unit() < 0.5 ? 1 : elements, entry);
    };
    fill(array.delays_s, scene.drive.repetition_hz > 0 ? 0 : random.unit());
    fill(array.preloads_n, random.unit());
    fill(array.amplitudes_m, random.unit());
    fill(array.materials, std::string(random.unit() < 0.5 ? "steel" : "my_solid"));
    fill(array.diameters_m, 1e-3 * (1 + random.unit()));
    scene.chain.materials.clear();
    scene.chain.diameters_m.clear();
    array.focus_m.clear();
    if (scene.drive.repetition_hz == 0) {
        array.focus_m = {random.unit(), -random.unit(), random.unit()};
    }
    scene.medium.load = FluidLoad::radiation;
    scene.numerics.rest_tolerance = 0;
}

Scene random_scene(std::uint64_t seed) {
    Randomise random(seed);
    Scene scene;
    scene.materials = {{"my_solid", Solid{}}, {"my-fluid", Fluid{}}};
    for (const SceneKey& key : keys_of(scene)) {
        random.set(scene, key);
    }
    scene.drive.repetition_hz =
        scene.drive.kind == DriveKind::none || scene.drive.kind == DriveKind::live
            ? 0
            : std::min(1e9, random.unit() * scene.drive.frequency_hz / scene.drive.cycles);
    scene.drive.start_s = 0;
    if (scene.drive.horn == HornModel::resonator) {
        scene.numerics.integrator.reset();
    }
    scene.chain.impact_spheres = std::min(scene.chain.impact_spheres, scene.chain.spheres);
    if (scene.numerics.step_s) {
        scene.numerics.accuracy.reset();
    }
    if (scene.end.model == PlateModel::modal) {
        scene.end.kind = EndKind::plate;
        scene.end.preload = PlatePreload::balanced;
        scene.end.stiffness_n_per_m.reset();
        scene.numerics.integrator.reset();
        scene.output.hydrophone_m = 0;
        std::ranges::fill(scene.output.points_m, std::array{0.0, 0.0, 0.0});
    }
    scene.end.thicknesses_m.resize(scene.end.materials.size(), 1e-9 + random.unit());
    if (scene.end.materials.empty()) {
        scene.end.loss_factors.clear();
    }
    if (scene.chain.damping_law != DampingLaw::dashpot) {
        scene.chain.damping_time_s = random.unit();
        scene.chain.damping_alpha = random.unit();
        scene.numerics.integrator.reset();
    }
    mend_array(scene, random);
    return scene;
}

RC_GTEST_PROP(SceneToml, WhatIsWrittenReadsBackToTheLastBit, (std::uint64_t seed)) {
    const Scene scene = random_scene(seed);
    RC_ASSERT(validate(scene).empty());
    const auto back = parse_scene(to_toml(scene), "scene.toml");
    RC_ASSERT(back.has_value());
    RC_ASSERT(back->scene == scene);
    RC_ASSERT(to_toml(back->scene) == to_toml(scene));
}

TEST(SceneToml, WritesEveryKeyThatIsSet) {
    Scene scene;
    scene.materials = {{"mine", Solid{1e9, 0.3, 1000}}};
    for (const SceneKey& key : keys_of(scene)) {
        if (key.is_optional) {
            const SceneValue one = key.traits.is_text            ? SceneValue("any text")
                                   : key.is_material             ? SceneValue("mine")
                                   : key.kind == ValueKind::word ? SceneValue(key.words.front())
                                                                 : *value_as(key.kind, std::int64_t{32});
            key.set(scene, test::filled_with(key, one));
        }
    }
    const auto section_of = [](const Scene& whole, const SceneKey& key) {
        const std::string text = to_toml(whole);
        const std::size_t begin = text.find('[' + key.section() + "]\n");
        return begin == std::string::npos ? "" : text.substr(begin, text.find("\n[", begin) - begin + 1);
    };
    for (const SceneKey& key : keys_of(scene)) {
        const std::string line = '\n' + std::string(key.key) + " = ";
        const std::string of_defaults = section_of(Scene{}, key);
        EXPECT_THAT(section_of(scene, key), HasSubstr(line + toml_text(*key.value(scene)))) << key.name;
        if (const auto standard = key.value(Scene{})) {
            EXPECT_THAT(of_defaults, HasSubstr(line + toml_text(*standard)));
        } else {
            EXPECT_THAT(of_defaults, Not(HasSubstr(line)));
        }
    }
}

TEST(SceneHash, IsThatOfTheTextWithoutLaterDefaults) {
    // Reference: FNV-1a of the text by an independent program. A new value here means that recordings of the
    // same scene no longer have the same hash.
    EXPECT_EQ(scene_hash(Scene{}), "8e2ec11a0e5a7b83");
    EXPECT_EQ(scene_hash(parse_scene("[chain]\nspheres = 6 # as before", "scene.toml").value().scene),
              scene_hash(Scene{}));
}

TEST(SceneHash, DependsOnTheTheoryOfAModalPlateAlone) {
    Scene lumped;
    lumped.end.theory = PlateTheory::thin;
    EXPECT_EQ(scene_hash(lumped), scene_hash(Scene{}));
    Scene thick;
    thick.end.model = PlateModel::modal;
    Scene thin = thick;
    thin.end.theory = PlateTheory::thin;
    EXPECT_NE(scene_hash(thin), scene_hash(thick));
}

TEST(SceneHash, ChangesWithTheLastDigit) {
    Scene scene;
    scene.drive.taper = std::nextafter(0.2, 1);
    EXPECT_NE(scene_hash(scene), scene_hash(Scene{}));
    scene.drive.taper = 0.2;
    scene.drive.repetition_hz = -0.0;  // equal scenes have equal hashes
    EXPECT_EQ(scene, Scene{});
    EXPECT_EQ(scene_hash(scene), scene_hash(Scene{}));
}

}  // namespace
}  // namespace hertzline
