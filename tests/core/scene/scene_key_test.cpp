#include "core/scene/scene_key.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/list_values.hpp"

namespace hertzline {
namespace {

using testing::Contains;
using testing::HasSubstr;

Scene scene_with_materials() {
    Scene scene;
    scene.materials = {{"tin", Solid{50e9, 0.36, 7265}}, {"oil", Fluid{900, 1400}}};
    return scene;
}

TEST(SceneKey, IsFoundByItsName) {
    const Scene scene = scene_with_materials();
    for (const SceneKey& key : keys_of(scene)) {
        const auto found = scene_key_named(scene, key.name);
        ASSERT_TRUE(found) << key.name;
        EXPECT_EQ(found->value(scene), key.value(scene));
        EXPECT_EQ(found->section() + '.' + std::string(found->key), key.name);
    }
    EXPECT_EQ(keys_of(scene).size(), scene_keys().size() + 7);
    EXPECT_THAT(scene_key_named(scene, "chain.sphere").error().allowed, HasSubstr("'chain.spheres'"));
    EXPECT_FALSE(scene_key_named(scene, "materials.oil.poissons_ratio"));
    EXPECT_FALSE(scene_key_named(Scene{}, "materials.oil.density_kg_per_m3"));
}

TEST(SceneKey, SetsItsOwnMemberAndNoOther) {
    const Scene before = scene_with_materials();
    const auto keys = keys_of(before);
    for (const SceneKey& key : keys) {
        Scene scene = before;
        const SceneValue one = key.traits.is_text            ? SceneValue("any text")
                               : key.kind == ValueKind::word ? SceneValue(words_of(scene, key).back())
                                                             : *value_as(key.kind, std::int64_t{31});
        const SceneValue value = test::filled_with(key, one);
        EXPECT_TRUE(key.set(scene, value)) << key.name;
        for (const SceneKey& other : keys) {
            EXPECT_EQ(other.value(scene), other.name == key.name ? value : other.value(before)) << other.name;
        }
        EXPECT_EQ(key.set(scene, std::nullopt), key.is_optional);
        EXPECT_EQ(key.value(scene).has_value(), !key.is_optional);
    }
}

TEST(SceneKey, KeepsItsValueWhereItHasNoSuchWordOrAnotherKind) {
    Scene scene;
    EXPECT_FALSE(scene_key_named(scene, "end.kind")->set(scene, std::string("roof")));
    EXPECT_FALSE(scene_key_named(scene, "chain.spheres")->set(scene, 3.0));
    EXPECT_FALSE(scene_key_named(scene, "numerics.step_s")->set(scene, std::int64_t{1}));
    EXPECT_EQ(scene, Scene{});
}

TEST(SceneKey, NeedsAWordThatAnotherKeyHas) {
    for (const SceneKey& key : scene_keys()) {
        if (const Need& needs = key.traits.needs; !needs.key.empty()) {
            const auto needed = scene_key_named(Scene{}, needs.key);
            ASSERT_TRUE(needed) << key.name;
            for (const std::string_view word : needs.words) {
                EXPECT_TRUE(word.empty() || std::ranges::count(needed->words, word) == 1) << key.name;
            }
        }
    }
    Scene scene;
    const auto taper = scene_key_named(scene, "drive.taper").value();
    EXPECT_FALSE(taper.has_effect(scene));
    scene.drive.envelope = Envelope::tukey;
    EXPECT_TRUE(taper.has_effect(scene));
    EXPECT_TRUE(scene_key_named(scene, "drive.cycles")->has_effect(scene));
}

TEST(SceneKey, NamesTheMaterialsOfItsSort) {
    const Scene scene = scene_with_materials();
    const auto solids = words_of(scene, scene_key_named(scene, "end.material").value());
    EXPECT_THAT(solids, Contains("tin"));
    EXPECT_THAT(solids, testing::Not(Contains("oil")));
    EXPECT_THAT(words_of(scene, scene_key_named(scene, "medium.material").value()), Contains("oil"));
    EXPECT_TRUE(words_of(scene, scene_key_named(scene, "chain.spheres").value()).empty());
}

TEST(SceneKey, ReadsTextAsItsKindAndJudgesIt) {
    const Scene scene;
    const auto read = [&](const char* name, const char* text) {
        const auto value = read_allowed(scene, scene_key_named(scene, name).value(), text);
        return value ? value_text(*value) : value.error().message();
    };
    EXPECT_EQ(read("chain.preload_n", "1"), "1");
    EXPECT_EQ(read("chain.preload_n", "5mN"), "0.005");
    EXPECT_EQ(
        read("chain.preload_n", "5 mm"),
        R"(chain.preload_n: found "5 mm", allowed: a number from 0 to 1e+09 N (N, with any prefix, as uN or mN))");
    EXPECT_EQ(read("chain.spheres", "0x10"), "16");
    EXPECT_EQ(read("end.kind", "wall"), "wall");
    EXPECT_EQ(read("chain.spheres", "6.0"),
              "chain.spheres: found 6.0, allowed: an integer from 1 to 10000000");
    EXPECT_EQ(read("chain.spheres", "0"), "chain.spheres: found 0, allowed: an integer from 1 to 10000000");
    EXPECT_EQ(read("drive.taper", "{}"), "drive.taper: found a table, allowed: a number from 0 to 1");
    EXPECT_EQ(read("drive.taper", "nan"), "drive.taper: found nan, allowed: a number from 0 to 1");
    EXPECT_EQ(read("end.kind", "wal"),
              R"(end.kind: found "wal", allowed: one of "plate", "wall", "free"; did you mean 'wall'?)");
    EXPECT_THAT(read("end.material", "water"),
                HasSubstr("found \"water\", a fluid, allowed: the name of a solid: "));
}

}  // namespace
}  // namespace hertzline
