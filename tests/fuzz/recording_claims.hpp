#pragma once
// Claims on any bytes that were read as a recording.

#include <filesystem>
#include <functional>
#include <memory>

#include "recordings/recording_formats.hpp"

namespace hertzline::fuzz {

using OpenRecording =
    std::function<std::unique_ptr<recordings::RecordingReader>(const std::filesystem::path& path)>;

/// Opens it as a user does who gives no sample rate. Its warnings are fit for a terminal, too.
std::unique_ptr<recordings::RecordingReader> open_as_a_user(const std::filesystem::path& path);

/// Claims that the recording opens, or that a std::runtime_error gives the reason in a message fit for a terminal. An
/// open recording has columns with names and units of a line, a rate, and rows of finite numbers that never go back, or
/// it breaks off with such an error. Its rows can be streamed.
void claim_recording_or_fault(const std::filesystem::path& path, const OpenRecording& open = open_as_a_user);

}  // namespace hertzline::fuzz
