#pragma once
#include "hertzline/scene.hpp"  // forwards until all includes follow
