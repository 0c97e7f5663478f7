#pragma once
#include "hertzline/samples.hpp"  // forwards until all includes follow
