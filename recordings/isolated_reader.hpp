#pragma once
// A recording that is read by a child process, which hands its rows over: for files on which a library may crash or
// hang, and for pipes, which may stay silent for ever.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>

#include "recordings/child_process.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Returns the child's work: it opens the recording and writes it to the pipe, `portion` rows at a time.
ChildProcess::Work reading(std::function<std::unique_ptr<RecordingReader>()> open, std::size_t portion);

/// Reads the recording from the child's pipe. Its bytes are not trusted: a child that crashed may write anything.
/// @param child does the work of reading() @throws std::runtime_error with path and fault, as read() does, also when
/// the child crashes, takes too much or writes nonsense
std::unique_ptr<RecordingReader> open_isolated_reader(const std::filesystem::path& path,
                                                      std::unique_ptr<ChildProcess> child);

}  // namespace hertzline::recordings
