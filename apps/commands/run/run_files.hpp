#pragma once
// Files of a run beside its recordings: spectra (--spectrum) and a picture (--plot).

#include <optional>
#include <span>
#include <string>

#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "hertzline/run.hpp"

namespace hertzline::app {

/// Adds the fault of each file that cannot hold spectra, or is another file of the run, too.
void check_spectra(std::span<const std::string> spectra, std::span<const std::string> recordings,
                   Faults& faults);

/// Saves frequency and amplitude of each tap of the record (hertzline/spectrum.hpp has the definition). Reports files that
/// cannot be written. @returns whether all of them were
bool save_spectra(std::span<const std::string> files, const hertzline::Run& run, const Json& provenance);

/// Draws the taps of the record; nothing where no file is named. Reports a picture that cannot be drawn.
/// @param title stands above @param band_from_hz as SpectrumAnalyser::analyse @returns whether it was drawn
bool save_picture(const std::string& file, const hertzline::Run& run, const Json& provenance,
                  const std::string& title, std::optional<double> band_from_hz);

}  // namespace hertzline::app
