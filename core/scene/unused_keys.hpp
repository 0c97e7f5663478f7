#pragma once
// Keys that a scene gives although they change nothing.

#include <string>
#include <vector>

#include "hertzline/scene.hpp"

namespace hertzline {

/// Warnings about values that differ from their defaults and have no effect in this scene, each with the key that it lacks or that is
/// used in its place. @param scene has passed validate()
std::vector<std::string> unused_key_warnings(const Scene& scene);

}  // namespace hertzline
