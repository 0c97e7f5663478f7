#pragma once

namespace hertzline::app {

/// The text of apps/plot/hertzline_plot.py, which is part of the program.
extern const char* const plot_script;

/// Its exit status when a module of Python is missing.
inline constexpr int plot_modules_missing = 3;
/// Its exit status when the file holds no sweep.
inline constexpr int plot_not_a_sweep = 4;

}  // namespace hertzline::app
