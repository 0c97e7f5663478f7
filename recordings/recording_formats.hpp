#pragma once
// The formats of recordings; the ending of a file's name picks one.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// The purpose for which a recording is named. Some formats are only read.
enum class Access { writing, reading };

/// Returns the endings of recordings: ".csv, .sigmf-meta, .sigmf-data".
std::string recording_endings(Access access = Access::writing);

/// Returns the ending that picks a file's format, in small letters: ".csv".
std::string recording_ending(const std::filesystem::path& path);

/// Returns the fault of a name that has no known ending. A device or FIFO without an ending gets a CSV.
std::optional<std::string> recording_fault(const std::filesystem::path& path,
                                           Access access = Access::writing);

/// Returns the name that all names of one recording share: x.sigmf-meta for x.sigmf-data.
std::filesystem::path recording_name(const std::filesystem::path& path);

/// Whether two recordings have a file in common: they are one, or one is a member of the other, a SigMF collection.
bool share_files(const std::filesystem::path& one, const std::filesystem::path& other);

/// The fault of a file that shares files with one before it.
std::optional<std::string> repeated_fault(const std::string& file, std::span<const std::string> before);

/// The faults of names of recordings that are written together: endings, and files in common.
std::vector<std::string> recordings_faults(std::span<const std::string> files);

/// Returns an upper bound of a recording's bytes, so that a full disk is noticed before the run.
double recording_bytes(const std::filesystem::path& path, double columns, double samples) noexcept;

/// Checks that a file could be written there, without beginning one. @throws std::runtime_error when not. Devices are not checked:
/// opening a FIFO and closing it again would end it.
void require_writable(const std::filesystem::path& path);

/// Begins a recording. @throws std::runtime_error that names the path and the reason, for an unknown ending, too.
std::unique_ptr<RecordingWriter> open_recording(const std::filesystem::path& path, const RecordingHead& head,
                                                Appearance appearance = Appearance::early);

/// Opens a recording for reading. @throws std::runtime_error like above.
std::unique_ptr<RecordingReader> open_reader(const std::filesystem::path& path,
                                             const ReadOptions& options = {});

}  // namespace hertzline::recordings
