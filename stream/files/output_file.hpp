#pragma once
// A file that exists under its name only when it is complete (staged_file), written through a buffer.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "stream/files/staged_file.hpp"

namespace hertzline::stream {

/// Buffered, sequential. Errors are std::system_error (a std::runtime_error): what() names the path and the
/// system's reason ("cannot write out.csv: No space left on device"). After an error the file is abandoned:
/// every later write or commit fails again.
class OutputFile {
public:
    /// Opens the temporary or the device, as StagedFile does.
    explicit OutputFile(std::filesystem::path path,
                        StagedFile::Devices devices = StagedFile::Devices::allowed);

    // Without commit() the temporary is removed; bytes still in the buffer are dropped.

    void write(std::string_view text);
    void write(std::span<const std::byte> bytes);

    /// Replaces bytes written before, as a header whose counts are known only at the end. Not for devices.
    void rewrite(std::uint64_t offset, std::string_view text);

    /// Writes out the buffer: what the disk has no room for is known now.
    void flush();

    /// Writes out the buffer, closes, and gives the file its name.
    void commit();

    /// As the user named it.
    const std::filesystem::path& path() const noexcept { return file_.path(); }

    /// It has no name to be given: a device, a FIFO.
    bool is_device() const noexcept { return file_.temporary().empty(); }

    /// Bytes taken by write() so far.
    std::uint64_t bytes() const noexcept { return bytes_; }

private:
    StagedFile file_;
    std::vector<std::byte> buffer_;
    std::uint64_t bytes_ = 0;
};

}  // namespace hertzline::stream
