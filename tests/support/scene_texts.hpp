#pragma once
// Scene texts in tests: their faults and their scenes.

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "hertzline/scene_file.hpp"

namespace hertzline::test {

/// Returns the faults of a text and its --set options, as the user reads them; empty for a valid scene. Fails the test
/// when there is neither a scene nor a fault.
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

/// Returns the scene of a text. Fails the test when the text has faults.
inline Scene scene_of(std::string_view text, const std::vector<std::string>& overrides = {}) {
    EXPECT_EQ(messages(text, overrides), std::vector<std::string>{});
    return parse_scene(text, "scene.toml", overrides).value_or(ParsedScene{}).scene;
}

}  // namespace hertzline::test
