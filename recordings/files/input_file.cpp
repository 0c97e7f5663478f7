#include "recordings/files/input_file.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/scene/text.hpp"

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

void InputFile::require(std::uint64_t size, std::string_view part) const {
    if (size > left()) {
        cannot_read(path_, fmt::format("cut short: {} needs {} bytes from byte {} on, the file ends at {}",
                                       part, size, at_, size_));
    }
}

void InputFile::read(std::span<std::byte> bytes, std::string_view part) {
    require(bytes.size(), part);
    file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file_) {
        cannot_read(path_, fmt::format("reading {} at byte {} failed", part, at_));
    }
    at_ += bytes.size();
}

std::string InputFile::text(std::uint64_t size, std::string_view part) {
    require(size, part);
    std::string text(size, '\0');
    read(std::as_writable_bytes(std::span(text)), part);
    return text;
}

void InputFile::seek(std::uint64_t offset) {
    at_ = std::min(offset, size_);
    file_.seekg(static_cast<std::streamoff>(at_));
}

void cannot_read(const std::filesystem::path& path, std::string_view reason) {
    constexpr std::size_t max_length = 300;  // it may quote the file
    throw std::runtime_error(
        fmt::format("cannot read {}: {}", printable_whole(path.string()), printable(reason, max_length)));
}

}  // namespace hertzline::recordings
