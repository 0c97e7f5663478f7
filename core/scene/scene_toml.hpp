#pragma once
#include "hertzline/scene_file.hpp"  // forwards until all includes follow
