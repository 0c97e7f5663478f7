#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"

namespace hertzline {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;

const fs::path scenes_folder = fs::path(HERTZLINE_SOURCE_DIR) / "scenes";

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

Scene shipped(std::string_view name) {
    const ShippedScene* found = find_shipped_scene(name);
    EXPECT_NE(found, nullptr) << name;
    return found != nullptr ? parse_scene(found->text, name).value().scene : Scene{};
}

TEST(ShippedScenes, AreThoseThatScriptsRelyOn) {
    std::vector<std::string_view> names;
    for (const ShippedScene& scene : shipped_scenes()) {
        names.push_back(scene.name);
    }
    EXPECT_THAT(names,
                testing::IsSupersetOf({"paper-vitreous-carbon", "paper-aluminium", "paper-pyrex",
                                       "paper-acrylic", "paper-silicone-rubber", "paper-wall", "paper-stream",
                                       "paper-stream-symplectic", "sonic-vacuum", "long-chain"}));
    EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

TEST(ShippedScenes, AreTheFilesOfTheScenesFolder) {
    std::set<std::string> files;
    for (const auto& entry : fs::directory_iterator(scenes_folder)) {
        if (entry.path().extension() == ".toml") {
            files.insert(entry.path().stem());
            const ShippedScene* scene = find_shipped_scene(entry.path().stem().string());
            ASSERT_NE(scene, nullptr) << entry.path();
            EXPECT_EQ(scene->text, contents(entry.path()));
        }
    }
    EXPECT_EQ(files.size(), shipped_scenes().size());
}

TEST(ShippedScenes, AreReadAndSurviveTheRoundTrip) {
    for (const ShippedScene& shipped_scene : shipped_scenes()) {
        const auto parsed = parse_scene(shipped_scene.text, shipped_scene.name);
        ASSERT_TRUE(parsed) << parsed.error().front().message();
        EXPECT_EQ(parse_scene(to_toml(parsed->scene), "again").value().scene, parsed->scene);
    }
}

TEST(ShippedScenes, AreDescribedInOneLine) {
    for (const ShippedScene& scene : shipped_scenes()) {
        EXPECT_TRUE(scene.text.starts_with("# " + std::string(scene.description) + "\n")) << scene.name;
        EXPECT_GT(scene.description.size(), 20) << scene.name;
        EXPECT_LT(scene.description.size(), 120) << scene.name;
    }
}

TEST(ShippedScenes, DifferFromThePaperInWhatTheirNamesSay) {
    const auto paper = [](const char* layer) {
        Scene scene;
        scene.end.material = layer;
        return scene;
    };
    EXPECT_EQ(shipped("paper-vitreous-carbon"), Scene{});
    EXPECT_EQ(shipped("paper-aluminium"), paper("aluminium"));
    EXPECT_EQ(shipped("paper-pyrex"), paper("pyrex"));
    EXPECT_EQ(shipped("paper-acrylic"), paper("acrylic"));
    EXPECT_EQ(shipped("paper-silicone-rubber"), paper("silicone_rubber"));

    Scene wall = paper("steel");
    wall.end.kind = EndKind::wall;
    EXPECT_EQ(shipped("paper-wall"), wall);

    Scene vacuum = wall;
    vacuum.chain.spheres = 10;
    vacuum.chain.preload_n = 0;
    EXPECT_EQ(shipped("sonic-vacuum"), vacuum);

    Scene long_chain = wall;
    long_chain.chain.spheres = 10'000;
    EXPECT_EQ(shipped("long-chain"), long_chain);

    Scene stream;
    stream.drive.repetition_hz = 1000;
    stream.output.duration_s = 10e-3;
    EXPECT_EQ(shipped("paper-stream"), stream);
    stream.numerics.integrator = Integrator::chin4a;
    EXPECT_EQ(shipped("paper-stream-symplectic"), stream);
}

TEST(ShippedScenes, AnUnknownNameFindsNothing) {
    EXPECT_EQ(find_shipped_scene("paper-gold"), nullptr);
    EXPECT_EQ(find_shipped_scene(""), nullptr);
}

TEST(ScenesReadme, ListsEveryScene) {
    const std::string readme = contents(scenes_folder / "README.md");
    for (const ShippedScene& scene : shipped_scenes()) {
        EXPECT_THAT(readme, HasSubstr("](" + std::string(scene.name) + ".toml)"));
    }
}

TEST(ScenesReadme, ItsExamplesAreScenes) {
    const std::string readme = contents(scenes_folder / "README.md");
    const auto example = [&](const std::string& first, const std::string& behind) {
        const auto begin = readme.find("    [end]\n    " + first);
        const auto end = readme.find(behind, begin);
        return parse_scene(readme.substr(std::min(begin, readme.size()), end - begin), "example")
            .value()
            .scene;
    };
    const Scene own = example("material = ", "\n`hertzline materials`");
    EXPECT_EQ(own.end.material, "filled_epoxy");
    EXPECT_EQ(std::get<Solid>(own.materials.at("filled_epoxy")), (Solid{8e9, 0.33, 2100}));
    const Scene layered = example("materials = ", "\nA wall has one");
    EXPECT_EQ(layered.end.thicknesses_m, (std::vector{0.2e-3, 0.5e-3}));
}

}  // namespace
}  // namespace hertzline
