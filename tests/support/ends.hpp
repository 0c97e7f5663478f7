#pragma once
// Chains with each kind of end.

#include "hertzline/scene.hpp"

namespace hertzline::test {

/// Returns the default scene with an end of that kind.
inline Scene scene_with_end(EndKind kind) {
    Scene scene;
    scene.end.kind = kind;
    return scene;
}

}  // namespace hertzline::test
