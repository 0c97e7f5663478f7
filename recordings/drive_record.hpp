#pragma once
// Where the record of a scene's drive lies. hertzline/drive_record.hpp reads it.

#include <filesystem>
#include <optional>

#include "hertzline/drive_record.hpp"

namespace hertzline::recordings {

/// Whether the scene gives the frequency that its record is measured by: as an option, or in the text that makes the drive a record.
bool gives_frequency(const ParsedScene& parsed);

/// The record that the scene names, where read_drive() looks for it; nothing where it names none.
std::optional<std::filesystem::path> record_of(const ParsedScene& parsed);

}  // namespace hertzline::recordings
