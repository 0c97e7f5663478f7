#pragma once
// Scenes of repeated bursts: one whose bursts are alike, and one whose motion grows.

#include "hertzline/scene_file.hpp"

namespace hertzline::test {

inline Scene shipped(const char* name) {
    return parse_scene(find_shipped_scene(name)->text, name, {})->scene;
}

/// Returns a scene in which each burst finds the chain at rest.
inline Scene steady_scene() {
    return shipped("paper-stream");
}

/// Returns a scene whose soft plate still rings when the next burst comes. Pilots watch two bursts; after these the contacts are pressed
/// twice as hard, and errors grow from 4e-5 to 8e-3.
inline Scene growing_scene() {
    Scene scene = shipped("paper-acrylic");
    scene.drive.repetition_hz = 2000;
    return scene;
}

}  // namespace hertzline::test
