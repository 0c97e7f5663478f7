#pragma once
// Scenes of repeated bursts: one that goes on as it begins, and one that does not.

#include "core/scene/scene_toml.hpp"
#include "core/scene/shipped_scenes.hpp"

namespace hertzline::test {

inline Scene shipped(const char* name) {
    return parse_scene(find_shipped_scene(name)->text, name, {})->scene;
}

/// Each burst finds the chain at rest.
inline Scene steady_scene() {
    return shipped("paper-stream");
}

/// A soft plate that still rings when the next burst comes. After two bursts, which pilots watch, the contacts are pressed twice as
/// hard as in them, and errors grow from 4e-5 to 8e-3.
inline Scene growing_scene() {
    Scene scene = shipped("paper-acrylic");
    scene.drive.repetition_hz = 2000;
    return scene;
}

}  // namespace hertzline::test
