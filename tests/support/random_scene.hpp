#pragma once
// Scenes drawn at random within the bounds of validate(), for the tests and for bench_random_scenes.

#include <cstdint>

#include "hertzline/scene.hpp"

namespace hertzline::test {

/// Draws a valid scene, the same for the same seed on every machine. Every key is drawn, sizes over decades around
/// sensible ones, and often exactly zero where that is a special case; one scene in eight has keys at their bounds.
/// Most have integrator and step set; one in sixteen asks for an accuracy.
Scene random_scene(std::uint64_t seed);

}  // namespace hertzline::test
