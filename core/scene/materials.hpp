#pragma once
#include "hertzline/materials.hpp"  // forwards until all includes follow
