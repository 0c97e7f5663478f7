#pragma once
// Scenes by name: a file, or a scene that is part of the program.

#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/fault.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/scene_toml.hpp"

namespace hertzline::measures {

/// Reads the scene of that name and changes it. @param name of a file, or of a shipped scene @param settings "section.key=value" each
/// @returns the scene, or every fault, with file and line or setting
tl::expected<ParsedScene, std::vector<Fault>> parse_scene_file(const std::string& name,
                                                               std::span<const std::string> settings = {});

/// The fault of a name that is neither a file's nor a shipped scene's.
Fault unknown_scene(const std::string& name);

/// Reads the scene of that name, a file's or a shipped one's. @throws std::invalid_argument with every fault, a line each
Scene read_scene(const std::string& name);

}  // namespace hertzline::measures
