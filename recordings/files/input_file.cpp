#include "recordings/files/input_file.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "recordings/files/errors.hpp"
#include <fmt/format.h>

namespace hertzline::recordings {

InputFile::InputFile(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code error;
    const auto status = std::filesystem::status(path_, error);
    if (!std::filesystem::exists(status)) {
        cannot_read(path_, error ? error.message() : std::generic_category().message(ENOENT));
    }
    if (!std::filesystem::is_regular_file(status)) {
        cannot_read(path_, "not a regular file");
    }
    file_.open(path_, std::ios::binary);
    const int reason = errno;
    size_ = std::filesystem::file_size(path_, error);
    if (!file_ || error) {
        cannot_read(path_, std::generic_category().message(error ? error.value() : reason));
    }
}

void InputFile::require(std::uint64_t size, std::string_view what) const {
    if (size > left()) {
        cannot_read(path_, fmt::format("cut short: {} needs {} bytes from byte {} on, the file ends at {}",
                                       what, size, at_, size_));
    }
}

void InputFile::read(std::span<std::byte> bytes, std::string_view what) {
    require(bytes.size(), what);
    file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file_) {
        cannot_read(path_, fmt::format("reading {} at byte {} failed", what, at_));
    }
    at_ += bytes.size();
}

std::string InputFile::text(std::uint64_t size, std::string_view what) {
    require(size, what);
    std::string text(size, '\0');
    read(std::as_writable_bytes(std::span(text)), what);
    return text;
}

void InputFile::seek(std::uint64_t offset) {
    at_ = std::min(offset, size_);
    file_.seekg(static_cast<std::streamoff>(at_));
}

}  // namespace hertzline::recordings
