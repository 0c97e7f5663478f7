#pragma once
// Scene texts in tests: what is said about them, and what they mean.

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/scene/scene_toml.hpp"

namespace hertzline::test {

/// What is wrong with a text and its --set options, as the user reads it; empty when it is a scene. Fails the
/// test when there is no scene though nothing is wrong.
inline std::vector<std::string> messages(std::string_view text,
                                         const std::vector<std::string>& overrides = {}) {
    const auto parsed = parse_scene(text, "scene.toml", overrides);
    std::vector<std::string> lines;
    if (!parsed) {
        EXPECT_FALSE(parsed.error().empty());
        for (const Fault& fault : parsed.error()) {
            lines.push_back(fault.message());
        }
    }
    return lines;
}

/// The scene of a text. Fails the test when there is none.
inline Scene scene_of(std::string_view text, const std::vector<std::string>& overrides = {}) {
    EXPECT_EQ(messages(text, overrides), std::vector<std::string>{});
    return parse_scene(text, "scene.toml", overrides).value_or(ParsedScene{}).scene;
}

}  // namespace hertzline::test
