#pragma once
// Claims on any text that was read as a scene.

#include "hertzline/scene_file.hpp"

namespace hertzline::fuzz {

/// A scene or faults, never both, never neither. Faults are fit for a terminal. A scene holds allowed numbers
/// only, is the same after it was written and read again, and gives finite constants.
void claim_scene_or_faults(const tl::expected<ParsedScene, std::vector<Fault>>& result);

}  // namespace hertzline::fuzz
