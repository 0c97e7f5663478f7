#pragma once
// A recording that is read by a child process, which hands its rows over: for files on which a library may crash or
// hang, and for pipes, which may be silent for as long as they like.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>

#include "recordings/child_process.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// What the child does: opens the recording and writes it to the pipe, `portion` rows at a time.
ChildProcess::Work reading(std::function<std::unique_ptr<RecordingReader>()> open, std::size_t portion);

/// The recording as the child writes it. What that says is not trusted: a child that crashed may say anything.
/// @param child does what reading() says @throws std::runtime_error that names the path and what is wrong, as read()
/// does: also when the child crashes, takes too much or says nonsense
std::unique_ptr<RecordingReader> open_isolated_reader(const std::filesystem::path& path,
                                                      std::unique_ptr<ChildProcess> child);

}  // namespace hertzline::recordings
