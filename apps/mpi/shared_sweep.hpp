#pragma once
// A sweep as rank 0 tells the others of it: what its journal says, and how many threads each rank has.

#include <string>

#include "studies/sweep/sweep.hpp"

namespace hertzline::app {

struct SharedSweep {
    studies::Sweep sweep;
    int threads = 1;
};

std::string shared_text(const studies::Sweep& sweep, int threads);

/// The same sweep here. From here on kernels use its instruction set.
/// @throws std::runtime_error that says in what this program is another one than that of rank 0
SharedSweep shared_sweep(const std::string& text);

}  // namespace hertzline::app
