#pragma once
#include "hertzline/resolve.hpp"  // forwards until all includes follow
