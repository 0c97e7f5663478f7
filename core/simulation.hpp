#pragma once
#include "hertzline/simulation.hpp"  // forwards until all includes follow
