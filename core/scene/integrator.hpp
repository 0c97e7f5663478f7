#pragma once
#include "hertzline/integrator.hpp"  // forwards until all includes follow
