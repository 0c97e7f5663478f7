#pragma once
// Scenes drawn at random over what validate() allows. For the tests and for bench_random_scenes.

#include <cstdint>

#include "core/scene/scene.hpp"

namespace hertzline::test {

/// A valid scene: the same one for the same seed, on every machine. Every key is drawn, sizes over decades
/// around sensible ones, and often exactly zero where that is a case of its own; one scene in eight goes to
/// the ends of what is allowed. Most have integrator and step set; one in sixteen asks for an accuracy.
Scene random_scene(std::uint64_t seed);

}  // namespace hertzline::test
