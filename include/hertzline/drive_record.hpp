#pragma once
// Records of the horn's motion: recordings that a scene names as its drive.

#include <functional>
#include <optional>
#include <string>

#include "hertzline/scene_file.hpp"

namespace hertzline {

/// Reads the record that drive.file of a scene names into drive.samples: from then on the scene needs no other file. The file gives the rate,
/// the quantity and the unit that the scene leaves open. The strongest line becomes drive.frequency_hz, also of samples that the scene has
/// itself, unless it is given. The name is taken relative to the folder of the scene's file, that of a --set option to the current folder.
/// Scenes without such a name stay as they are. @param warn takes sentences about the file, which begin with the scene's name
/// @returns the fault of a file that is missing, is not a recording, is too long or has gaps; nothing where there is none
std::optional<Fault> read_drive(ParsedScene& parsed,
                                const std::function<void(const std::string&)>& warn = {});

}  // namespace hertzline
