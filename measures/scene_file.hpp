#pragma once
#include "hertzline/scene_file.hpp"  // forwards until all includes follow

namespace hertzline::measures {
using hertzline::parse_scene_file;
using hertzline::read_scene;
using hertzline::unknown_scene;
}  // namespace hertzline::measures
