#pragma once
// run --plot: a picture of the measured outputs.

#include <string>

#include "measures/run.hpp"

#include "apps/console/output.hpp"
#include "core/scene/scene.hpp"

namespace hertzline::app {

/// Draws the taps of the record; nothing where no file is named. Reports a picture that cannot be drawn.
/// @param title stands above @returns whether it was drawn
bool save_picture(const std::string& file, const measures::Run& run, const Json& provenance,
                  const std::string& title);

}  // namespace hertzline::app
