#pragma once
// A scene whose points are run fast: a short chain on a wall, and few samples.

#include "tests/apps/program.hpp"

namespace hertzline::test {

inline const Words quick_points{"paper-wall", "--set", "output.duration_s=5e-5", "--set", "drive.cycles=2"};
inline const Words quick_sweep = with({"sweep"}, quick_points);

}  // namespace hertzline::test
