#pragma once
// A file that exists under its name only when it is complete.
//
// The bytes go to a temporary beside the target (FILE.partial-...), which commit() renames over it. Without
// commit the temporary is removed and the target is as it was. What is not a regular file (/dev/null, a FIFO,
// the program's own /dev/stdout) cannot be replaced by renaming: it is written straight to.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace hertzline {

/// Buffered, sequential. Errors are std::system_error (a std::runtime_error): what() names the path and the
/// system's reason ("cannot write out.csv: No space left on device"). After an error the file is abandoned:
/// every later write or commit throws again.
class OutputFile {
public:
    /// Opens the temporary or the device. Everything that can be known beforehand fails here: a missing or
    /// unwritable directory, a target that is a directory or read-only. A FIFO waits for its reader.
    /// A symbolic link is followed, not replaced. A new file gets the permissions that any new file would;
    /// one that replaces another gets its permissions, and its owner where the system lets us.
    explicit OutputFile(std::filesystem::path path);

    /// Without commit(): removes the temporary; bytes still in the buffer are dropped.
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);
    void write(std::span<const std::byte> bytes);

    /// Writes out the buffer, closes, and gives the file its name. Does not wait for the disk (no fsync): a
    /// power cut may still lose the file, a crash of the program may not.
    void commit();

    /// As the user named it.
    const std::filesystem::path& path() const noexcept { return path_; }

    /// Bytes taken by write() so far.
    std::uint64_t bytes() const noexcept { return bytes_; }

private:
    void open_straight();
    void open_temporary();
    void flush();
    void abandon() noexcept;
    [[noreturn]] void fail(int reason);

    std::filesystem::path path_;
    std::filesystem::path target_;     // path_ with symbolic links followed
    std::filesystem::path temporary_;  // empty: written straight
    std::vector<std::byte> buffer_;
    std::uint64_t bytes_ = 0;
    int descriptor_ = -1;
    int failure_ = 0;  // errno of the first error
};

}  // namespace hertzline
