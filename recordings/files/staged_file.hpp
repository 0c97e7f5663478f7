#pragma once
// A file that gets its name only when it is complete; for code that writes its bytes itself.
//
// The bytes go to a temporary beside the target (FILE.partial-...), which commit() renames over it. Without commit
// the temporary is removed and the target is as it was. A target that is not a regular file (/dev/null, a FIFO, the
// program's own /dev/stdout) cannot be replaced by renaming: it is written directly, or refused.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace hertzline::recordings {

/// Errors are std::system_error (a std::runtime_error): what() names the path and the system's reason
/// ("cannot write out.csv: No space left on device").
class StagedFile {
public:
    enum class Devices { allowed, refused };

    /// Opens the temporary or the device. Everything that can be known beforehand fails here: a missing or unwritable
    /// directory, a target that is a directory or read-only. A FIFO waits for its reader. A symbolic link is
    /// followed, not replaced; a stranger's in a folder like /tmp is refused. A new file gets the permissions of any
    /// new file; one that replaces another gets its permissions, and its owner where the system permits. It is never
    /// open to more users than the old one, not even for a moment or with another group.
    StagedFile(std::filesystem::path path, Devices devices);

    /// Without commit(), appear() or keep(): removes the temporary.
    ~StagedFile();
    StagedFile(const StagedFile&) = delete;
    StagedFile& operator=(const StagedFile&) = delete;

    /// The path as the user gave it.
    const std::filesystem::path& path() const noexcept { return path_; }

    /// Returns the file that takes the bytes: for libraries that open files by name. Empty for a device.
    const std::filesystem::path& temporary() const noexcept { return temporary_; }

    /// Open for reading and writing (a device: for writing), or -1 once it is over.
    int descriptor() const noexcept { return descriptor_; }

    /// Closes it; then only commit(), keep() and abandon() are left. Some file systems (NFS) report a full disk or
    /// quota only here.
    void close();

    /// Closes, unless it is closed, and gives the file its name. Does not wait for the disk (no fsync): a power cut
    /// may still lose the file, a crash of the program may not.
    void commit();

    /// Gives the file its name now, while it keeps growing, and replaces an older one. From here on its bytes stay
    /// under that name, unless it is abandoned. While it is open, no other StagedFile of that name can be begun or appear.
    void appear();

    /// @throws std::runtime_error where the file of that name is one that still grows, of this or another program
    void require_replaceable() const;

    /// Closes it and keeps it under the temporary's name, after appear() under its own.
    void keep() noexcept;

    /// Closes and removes it. Does nothing after commit() or keep().
    void abandon() noexcept;

    bool is_closed() const noexcept { return descriptor_ < 0; }
    /// Whether the system reported an error when it was closed, so that its contents are unknown.
    bool is_doubtful() const noexcept { return doubtful_; }

    /// @throws std::system_error of that errno; from then on commit() and require_open() throw it again. The
    /// file stays open: resume(), keep() or abandon() it.
    [[noreturn]] void fail(int reason);
    /// Clears the failure, to save the rest.
    void resume() noexcept { failure_ = 0; }

    /// @throws std::system_error after a failure, std::logic_error after commit, where it is misuse.
    void require_open() const;

private:
    void open_straight();
    void open_temporary();
    int close_descriptor() noexcept;

    std::filesystem::path path_;
    std::filesystem::path target_;     // path_ with symbolic links followed
    std::filesystem::path temporary_;  // empty: written straight; target_ after appear()
    int descriptor_ = -1;
    bool appeared_ = false;
    bool doubtful_ = false;
    bool settled_ = false;  // the temporary is there no more, or shall stay
    int failure_ = 0;       // errno of the first error
};

/// Writes all bytes to a descriptor, of which a system call may take a part only, where the file stands. @returns 0, or the errno of the call that failed.
[[nodiscard]] int write_all(int descriptor, std::span<const std::byte> bytes) noexcept;

/// Writes all bytes from `offset` [bytes] on; where the file stands does not change. @returns the same.
[[nodiscard]] int write_all_at(int descriptor, std::span<const std::byte> bytes,
                               std::uint64_t offset) noexcept;

/// @throws std::runtime_error "cannot write x.npy: reason"
[[noreturn]] void cannot_write(const std::filesystem::path& path, std::string_view reason);

}  // namespace hertzline::recordings
