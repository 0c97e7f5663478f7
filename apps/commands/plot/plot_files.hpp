#pragma once
// The Python files of apps/plot, which are part of the program.

#include <span>

namespace hertzline::app {

struct PlotFile {
    const char* path;  ///< below apps/plot
    const char* text;
};

/// Defined in a file that apps/CMakeLists.txt writes.
extern const std::span<const PlotFile> plot_files;

}  // namespace hertzline::app
