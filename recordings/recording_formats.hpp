#pragma once
// The formats of recordings; the ending of a file's name picks one.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Every ending that a recording can have: ".csv, .sigmf-meta, .sigmf-data".
std::string recording_endings();

/// The ending that picks a file's format, in small letters: ".csv".
std::string recording_ending(const std::filesystem::path& path);

/// Why a file of that name cannot be recorded to (unknown ending); nothing when it can. A device or FIFO
/// without an ending gets a CSV.
std::optional<std::string> recording_fault(const std::filesystem::path& path);

/// The name that all names of one recording share: x.sigmf-meta for x.sigmf-data.
std::filesystem::path recording_name(const std::filesystem::path& path);

/// Bytes of a recording, from above: so that a full disk is noticed before the run.
double recording_bytes(const std::filesystem::path& path, double columns, double samples) noexcept;

/// @throws std::runtime_error when no file could be written there, without beginning one. Devices are not checked:
/// opening a FIFO and closing it again would end it.
void require_writable(const std::filesystem::path& path);

/// Begins a recording. @throws std::runtime_error that names the path and the reason, for an unknown ending, too.
std::unique_ptr<RecordingWriter> open_recording(const std::filesystem::path& path, const RecordingHead& head,
                                                Appearance appearance = Appearance::early);

/// Opens a recording for reading. @throws std::runtime_error like above.
std::unique_ptr<RecordingReader> open_reader(const std::filesystem::path& path);

}  // namespace hertzline::recordings
