#pragma once
// The form of every error of a file: the failed action, the path, the reason.

#include <filesystem>
#include <string_view>

namespace hertzline::recordings {

/// @throws std::runtime_error "cannot write x.npy: reason"
[[noreturn]] void cannot_write(const std::filesystem::path& path, std::string_view reason);

/// @throws std::runtime_error "cannot read x.npy: reason". The reason may quote the file: it is made printable.
[[noreturn]] void cannot_read(const std::filesystem::path& path, std::string_view reason);

}  // namespace hertzline::recordings
