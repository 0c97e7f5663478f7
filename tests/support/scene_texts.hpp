#pragma once
// Scene texts in tests: what is said about them, and what they mean.

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/scene/scene_toml.hpp"

namespace hertzline::test {

/// What is wrong with a text and its --set options, as the user reads it. Fails the test unless there is a
/// scene exactly when nothing is wrong.
inline std::vector<std::string> messages(std::string_view text,
                                         const std::vector<std::string>& overrides = {}) {
    const SceneResult result = parse_scene(text, "scene.toml", overrides);
    EXPECT_EQ(result.scene.has_value(), result.problems.empty());
    std::vector<std::string> lines;
    for (const Problem& problem : result.problems) {
        lines.push_back(problem.message());
    }
    return lines;
}

/// The scene of a text. Fails the test when there is none.
inline Scene scene_of(std::string_view text, const std::vector<std::string>& overrides = {}) {
    EXPECT_EQ(messages(text, overrides), std::vector<std::string>{});
    return parse_scene(text, "scene.toml", overrides).scene.value_or(Scene{});
}

}  // namespace hertzline::test
