#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/scene/scene_fields.hpp"
#include "core/scene/scene_toml.hpp"

namespace hertzline {
namespace {

using testing::HasSubstr;
using testing::Not;

// Visits the fields and gives each a random value that is allowed.
struct Randomise {
    std::mt19937_64& bits;
    double unit() { return std::uniform_real_distribution<double>(0, 1)(bits); }
    bool coin() { return (bits() & 1) != 0; }

    template <class Member, class Allowed>
    void operator()(const fields::Key& key, std::optional<Member>& member, const Allowed& allowed) {
        member.reset();
        if (coin()) {
            (*this)(key, member.emplace(), allowed);
        }
    }
    void operator()(const fields::Key& /*key*/, double& member, const fields::Range& range) {
        const double span = range.max - range.min;
        const double scale = std::pow(10.0, -12 * unit());  // small values as often as large ones
        member = std::clamp(range.min + span * unit() * scale, range.min, range.max);
        if (range.bounds == fields::Bounds::excluded) {
            member = std::clamp(member, std::nextafter(range.min, 0), std::nextafter(range.max, 0));
        }
    }
    void operator()(const fields::Key& /*key*/, std::int64_t& member, const fields::Count& count) {
        member = std::uniform_int_distribution<std::int64_t>(count.min, count.max)(bits);
    }
    template <class Choice>
    void operator()(const fields::Key& /*key*/, Choice& member, fields::OneOf<Choice> /*words*/) {
        member = Words<Choice>::all[bits() % Words<Choice>::all.size()].choice;
    }
    void operator()(const fields::Key& /*key*/, std::string& member, fields::MaterialSort sort) {
        member = sort == fields::MaterialSort::fluid ? (coin() ? "water" : "my-fluid")
                                                     : (coin() ? "pyrex" : "my_solid");
    }
};

Scene random_scene(std::uint64_t seed) {
    std::mt19937_64 bits(seed);
    Randomise randomise{bits};
    Scene scene;
    fields::visit_scene(scene, randomise);
    scene.drive.repetition_hz =
        std::min(1e9, randomise.unit() * scene.drive.frequency_hz / scene.drive.cycles);
    if (scene.numerics.step_s) {
        scene.numerics.accuracy.reset();
    }
    if (scene.end.model == PlateModel::modal) {
        scene.end.kind = EndKind::plate;
        scene.end.preload = PlatePreload::balanced;
        scene.end.stiffness_n_per_m.reset();
        scene.numerics.integrator.reset();
        scene.output.hydrophone_m = 0;
    }
    if (scene.chain.damping_law != DampingLaw::dashpot) {
        scene.chain.damping_time_s = randomise.unit();
        scene.chain.damping_alpha = randomise.unit();
        scene.numerics.integrator.reset();
    }
    Solid solid;
    fields::visit_solid(solid, "materials.my_solid", randomise);
    Fluid fluid;
    fields::visit_fluid(fluid, "materials.my-fluid", randomise);
    scene.materials = {{"my_solid", solid}, {"my-fluid", fluid}};
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
    scene.end.stiffness_n_per_m = 1e5;
    scene.numerics.integrator = Integrator::chin4a;
    scene.numerics.step_s = 1e-9;
    scene.numerics.poles = 32;
    scene.end.model = PlateModel::modal;
    scene.chain.damping_law = DampingLaw::tsuji;
    scene.chain.damping_time_s = 1e-6;
    scene.chain.damping_alpha = 0.1;
    scene.end.modes = 3;
    scene.end.loss_factor = 0.01;
    scene.medium.load = FluidLoad::none;
    scene.output.hydrophone_m = 0.02;
    const std::string text = to_toml(scene);
    for (const SceneKey& key : scene_keys()) {
        const std::string name = key.key.substr(key.key.find('.') + 1);
        if (name != "accuracy") {
            EXPECT_THAT(text, HasSubstr('\n' + name + " = "));
        }
    }
    EXPECT_THAT(text, Not(HasSubstr("accuracy")));
    const std::string of_defaults = to_toml(Scene{});
    for (const SceneKey& key : scene_keys()) {
        const std::string name = '\n' + key.key.substr(key.key.find('.') + 1) + " = ";
        if (key.default_value.empty()) {
            EXPECT_THAT(of_defaults, Not(HasSubstr(name)));
        } else {
            EXPECT_THAT(of_defaults, HasSubstr(name + key.default_value));
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

TEST(SceneHash, ChangesWithEveryValue) {
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
