#pragma once
// Scenes by name: from a scene file, from those that are part of the program, or from a recording.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline::recordings {

/// Whether the name is that of a file that recordings are read from.
bool is_recording(const std::string& name);

/// The provenance of a recording; nothing where the name is no recording's. @throws std::runtime_error when it cannot be read
std::optional<Json> provenance_of(const std::string& name);

/// Reads the scene of that name, changes it, and reads the record of its drive. The scene in a recording is the one that was asked for:
/// a step that the program chose is left open, as it suits no other scene. @param name of a file, or of a shipped scene
/// @param settings "section.key=value" each @param warn takes sentences that begin with the name
/// @returns the scene, or every fault, with file and line or setting
tl::expected<ParsedScene, std::vector<Fault>> parse_named_scene(
    const std::string& name, std::span<const std::string> settings,
    const std::function<void(const std::string&)>& warn);

}  // namespace hertzline::recordings
