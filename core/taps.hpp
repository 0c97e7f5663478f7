#pragma once
#include "hertzline/taps.hpp"  // forwards until all includes follow
