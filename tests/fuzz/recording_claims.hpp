#pragma once
// What must hold of any bytes that were read as a recording.

#include <filesystem>
#include <functional>
#include <memory>

#include "recordings/recording_formats.hpp"

namespace hertzline::fuzz {

using OpenRecording =
    std::function<std::unique_ptr<recordings::RecordingReader>(const std::filesystem::path& path)>;

/// The recording opens, or a std::runtime_error says why not, in a message that is fit for a terminal. What
/// opens has columns with names and units of a line, a rate, and rows of finite numbers that never go back,
/// or it breaks off with such an error. What it holds can be streamed.
/// @param open as stream::open_reader
void claim_recording_or_fault(const std::filesystem::path& path,
                              const OpenRecording& open = recordings::open_reader);

}  // namespace hertzline::fuzz
