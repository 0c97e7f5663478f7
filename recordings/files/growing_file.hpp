#pragma once
// A file of records that has its name from early on and is whole at any time: for recordings that shall
// survive the sudden end of the program.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "recordings/files/staged_file.hpp"

namespace hertzline::recordings {

/// Buffered. Flushed records stay, whatever happens later; errors are those of StagedFile.
class GrowingFile {
public:
    /// Refuses unwritable files, as StagedFile does, and devices. Nothing is replaced yet.
    GrowingFile(std::filesystem::path path, std::size_t record_bytes);

    /// Takes the file's name and replaces an older file.
    void appear() { file_.appear(); }

    /// Takes whole records. Flushes by itself only when they do not fit().
    void write(std::span<const std::byte> records);
    bool fits(std::size_t bytes) const noexcept { return buffer_.size() + bytes <= max_buffered_; }

    /// Hands the buffer to the system, which keeps it when the program is killed. Fails when the file is
    /// there no more: the bytes would go nowhere.
    void flush();

    /// Flushes and closes.
    void close();

    /// Closes, unless it is closed, and gives the file its name.
    void commit();

    /// See StagedFile.
    bool is_closed() const noexcept { return file_.is_closed(); }
    bool is_doubtful() const noexcept { return file_.is_doubtful(); }

    /// Fails when the file is there no more: removed, or replaced by another of its name.
    void require_present();

    /// Whole records that the system has taken.
    std::int64_t records() const noexcept;

    /// Closes and drops unflushed records. @returns the path of the rest
    std::filesystem::path keep() noexcept;

    /// Closes and removes it.
    void abandon() noexcept { file_.abandon(); }

private:
    [[noreturn]] void fail(int reason);

    StagedFile file_;
    std::size_t record_bytes_;
    std::size_t max_buffered_;  // whole records
    std::vector<std::byte> buffer_;
};

}  // namespace hertzline::recordings
