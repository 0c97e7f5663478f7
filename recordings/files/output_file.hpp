#pragma once
// A file that exists under its name only when it is complete (staged_file), or once it appear()s, written through a buffer.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/files/staged_file.hpp"

namespace hertzline::recordings {

/// Buffered, sequential. Errors are std::system_error (a std::runtime_error): what() names the path and the
/// system's reason ("cannot write out.csv: No space left on device"). After an error every later write or
/// commit fails again, until resume_at().
class OutputFile {
public:
    /// Opens the temporary or the device, as StagedFile does.
    /// @param record_bytes the file consists of records of that size: it holds whole ones after each flush, and after a failed one
    explicit OutputFile(std::filesystem::path path,
                        StagedFile::Devices devices = StagedFile::Devices::allowed,
                        std::size_t record_bytes = 1);

    // Without commit() or keep() the temporary is removed; bytes still in the buffer are dropped.

    /// Flushes by itself only when the bytes do not fit().
    void write(std::string_view text);
    void write(std::span<const std::byte> bytes);
    bool fits(std::size_t bytes) const noexcept;

    /// Replaces earlier bytes, such as a header whose counts are known only at the end. Not for devices.
    void rewrite(std::uint64_t offset, std::string_view text);

    /// Writes out the buffer, so that a full disk is noticed now.
    void flush();

    /// Writes out the buffer and closes, so that errors which the system reports only then are noticed now. Only
    /// commit() and keep() may follow.
    void close();

    /// Closes, unless it is closed, and gives the file its name.
    void commit();

    /// Gives the file its name now, while it keeps growing, and replaces an older one. Flushed bytes then survive the sudden end
    /// of the program.
    void appear() { file_.appear(); }
    /// See StagedFile.
    void require_replaceable() const { file_.require_replaceable(); }

    /// Fails when the file is gone: removed, or replaced by another of its name. Its bytes would go nowhere.
    void require_present();

    /// Returns the bytes in the file, after a failed flush with a part of its buffer; 0 once the file is gone.
    std::uint64_t size() const noexcept;

    /// Returns the bytes of the file from there on.
    std::string text_from(std::uint64_t offset) const;

    /// Cuts the file there and continues there; clears a failure. Not for devices.
    void resume_at(std::uint64_t size);

    /// Closes it and keeps it under the temporary's name. @returns that name
    std::filesystem::path keep() noexcept;

    /// Closes and removes it.
    void abandon() noexcept { file_.abandon(); }

    /// See StagedFile.
    bool is_closed() const noexcept { return file_.is_closed(); }
    bool is_doubtful() const noexcept { return file_.is_doubtful(); }

    /// The path as the user gave it.
    const std::filesystem::path& path() const noexcept { return file_.path(); }

    /// It has no name to be given: a device, a FIFO.
    bool is_device() const noexcept { return file_.temporary().empty(); }

    /// Bytes taken by write() so far.
    std::uint64_t bytes() const noexcept { return bytes_; }

private:
    StagedFile file_;
    std::size_t record_bytes_;
    std::size_t buffer_bytes_;  // whole records
    std::vector<std::byte> buffer_;
    std::uint64_t bytes_ = 0;
};

}  // namespace hertzline::recordings
