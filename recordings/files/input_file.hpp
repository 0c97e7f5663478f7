#pragma once
// A regular file that is read from start to end and is not trusted.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

namespace hertzline::recordings {

/// Errors are std::runtime_error that names the path and the reason.
class InputFile {
public:
    /// Refuses all but regular files: a FIFO would wait, a device has no size.
    explicit InputFile(std::filesystem::path path);

    /// Fills `bytes`. @param part named by the error @throws std::runtime_error when the file ends inside it
    void read(std::span<std::byte> bytes, std::string_view part);
    /// Reads `size` characters, allocated only if the file has them.
    std::string text(std::uint64_t size, std::string_view part);
    void seek(std::uint64_t offset);

    std::uint64_t size() const noexcept { return size_; }
    std::uint64_t left() const noexcept { return size_ - at_; }
    const std::filesystem::path& path() const noexcept { return path_; }

private:
    void require(std::uint64_t size, std::string_view part) const;

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t size_ = 0;
    std::uint64_t at_ = 0;
};

/// @throws std::runtime_error "cannot read x.npy: reason". The reason may quote the file: it is made printable.
[[noreturn]] void cannot_read(const std::filesystem::path& path, std::string_view reason);

}  // namespace hertzline::recordings
