#pragma once
// The spectra of a run as files.

#include <span>
#include <string>

#include "measures/run.hpp"

#include "apps/console/output.hpp"
#include "core/scene/scene.hpp"

namespace hertzline::app {

/// @throws WrongUse that names every file that cannot hold spectra, or is another file of the run, too
void refuse_wrong_spectra(std::span<const std::string> spectra, std::span<const std::string> recordings);

/// Saves frequency and amplitude of each tap of the record (stream/measures/spectrum.hpp has the definition). Reports files that
/// cannot be written. @returns whether all of them were
bool save_spectra(std::span<const std::string> files, const measures::Run& run, const Json& provenance);

}  // namespace hertzline::app
