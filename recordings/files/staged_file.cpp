#include "recordings/files/staged_file.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/scene/text.hpp"

namespace hertzline::recordings {
namespace fs = std::filesystem;
namespace {

constexpr int max_links = 40;                // as the kernel does (path_resolution(7))
constexpr std::size_t max_stem_bytes = 200;  // leaves room for the ending in a name of 255 bytes

[[noreturn]] void refuse(const fs::path& path, int reason) {
    throw std::system_error(reason, std::generic_category(),
                            "cannot write " + printable_whole(path.string()));
}

/// Returns the directory that holds path, without links; fails when it does not exist.
fs::path directory_of(const fs::path& path, const fs::path& named_by_user) {
    std::error_code error;
    const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
    fs::path directory = fs::canonical(parent, error);
    if (error) {
        throw std::system_error(error, "cannot write " + printable_whole(named_by_user.string()) +
                                           ": directory " + printable_whole(parent.string()));
    }
    return directory;
}

/// A link that a stranger has laid in a folder where everybody may lay one (/tmp): following it would let him choose
/// the file that is replaced. The kernel's rule (protected_symlinks in proc(5)), which readlink() does not know.
bool is_a_strangers(const fs::path& link, const fs::path& directory) {
    struct stat of_link {};
    struct stat of_directory {};
    if (::lstat(link.c_str(), &of_link) != 0 || ::stat(directory.c_str(), &of_directory) != 0) {
        return true;
    }
    constexpr mode_t open_to_all = S_ISVTX | S_IWOTH;
    return (of_directory.st_mode & open_to_all) == open_to_all && of_link.st_uid != ::geteuid() &&
           of_link.st_uid != of_directory.st_uid;
}

/// Returns the place of a file of that name, without links. Links are followed one by one and not by realpath(), which knows
/// nothing of a link to a file that does not exist yet, and would follow /dev/stdout into the file behind it.
fs::path without_links(const fs::path& named_by_user) {
    fs::path path = named_by_user;
    for (int followed = 0; followed < max_links; ++followed) {
        const fs::path directory = directory_of(path, named_by_user);
        path = directory / path.filename();
        std::error_code error;
        if (directory.parent_path().parent_path() == "/proc" || !fs::is_symlink(path, error)) {
            return path;
        }
        if (is_a_strangers(path, directory)) {
            refuse(named_by_user, EACCES);
        }
        const fs::path next = fs::read_symlink(path, error);
        if (error) {
            refuse(named_by_user, error.value());
        }
        path = directory / next;  // an absolute next replaces the directory
    }
    refuse(named_by_user, ELOOP);
}

/// The number N when path is this process's own open file N (/proc/PID/fd/N, where /dev/stdout leads).
int own_descriptor(const fs::path& path) {
    if (path.parent_path() != "/proc/" + std::to_string(::getpid()) + "/fd") {
        return -1;
    }
    return parsed_number<int>(path.filename().string()).value_or(-1);
}

/// Owner and mode of the file that is replaced, as far as the system lets us; neither is worth losing the data for.
void inherit(int descriptor, const struct stat& replaced) noexcept {
    constexpr auto as_it_is = static_cast<uid_t>(-1);
    // Owner first: changing it clears bits of the mode.
    const bool same_group = ::fchown(descriptor, replaced.st_uid, replaced.st_gid) == 0 ||
                            ::fchown(descriptor, as_it_is, replaced.st_gid) == 0;
    const mode_t mode = replaced.st_mode & 07777;
    const mode_t as_others = (mode & S_IRWXO) << 3;
    // Another group may do no more than everybody.
    [[maybe_unused]] const int failed =
        ::fchmod(descriptor, same_group ? mode : mode & (~mode_t{S_IRWXG} | as_others));
}

std::string random_ending() {
    std::random_device random;
    std::array<char, 24> text{};
    const int length = std::snprintf(text.data(), text.size(), ".partial-%08x", random());
    return {text.data(), static_cast<std::size_t>(length)};
}

/// Calls write(bytes that are left, how many were written) until none is left.
template <class Write>
int repeat(std::span<const std::byte> bytes, Write write) noexcept {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t written = write(bytes.subspan(done), done);
        if (written >= 0) {
            done += static_cast<std::size_t>(written);
        } else if (errno != EINTR) {
            return errno;
        }
    }
    return 0;
}

}  // namespace

StagedFile::StagedFile(fs::path path, Devices devices) : path_(std::move(path)) {
    if (path_.empty()) {
        throw std::system_error(ENOENT, std::generic_category(), "cannot write to a file without a name");
    }
    if (!path_.has_filename()) {
        refuse(path_, EISDIR);
    }
    target_ = without_links(path_);
    struct stat existing {};
    const bool exists = ::stat(target_.c_str(), &existing) == 0;
    if (!exists && errno != ENOENT) {
        refuse(path_, errno);
    }
    if (exists && S_ISDIR(existing.st_mode)) {
        refuse(path_, EISDIR);
    }
    const bool device = own_descriptor(target_) >= 0 || (exists && !S_ISREG(existing.st_mode));
    if (!device) {
        require_replaceable();
        open_temporary();
    } else if (devices == Devices::allowed) {
        open_straight();
    } else {
        throw std::runtime_error(
            "cannot write " + printable_whole(path_.string()) +
            ": found a device or pipe, allowed: a file; the format is not written in order");
    }
}

void StagedFile::open_straight() {
    // The program's own stdout is duplicated, not reopened: a file behind it would be reopened at its start,
    // and everything else that the program prints would overwrite it.
    const int own = own_descriptor(target_);
    descriptor_ = own >= 0 ? ::fcntl(own, F_DUPFD_CLOEXEC, 0)
                           : ::open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor_ < 0) {
        refuse(path_, errno);
    }
}

void StagedFile::open_temporary() {
    struct stat existing {};
    const bool replaces = ::stat(target_.c_str(), &existing) == 0;
    // Renaming would replace a read-only file too; its owner did not want that.
    if (replaces && ::access(target_.c_str(), W_OK) != 0) {
        refuse(path_, errno);
    }
    const std::string stem = target_.filename().string().substr(0, max_stem_bytes);
    // Not mkstemp: its files are private (0600), and the umask cannot be read without changing it for all threads.
    for (int attempt = 0; attempt < 100 && descriptor_ < 0; ++attempt) {
        temporary_ = target_.parent_path() / (stem + random_ending());
        // Ours alone until it has the target's group.
        const mode_t mode = replaces ? S_IRUSR | S_IWUSR : 0666;
        descriptor_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (descriptor_ < 0 && errno != EEXIST) {
            refuse(path_, errno);
        }
    }
    if (descriptor_ < 0) {
        refuse(path_, EEXIST);
    }
    if (replaces) {
        inherit(descriptor_, existing);
    }
}

void StagedFile::require_replaceable() const {
    const int descriptor = ::open(target_.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
    const bool locked =
        descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (descriptor >= 0) {
        ::close(descriptor);
    }
    if (locked) {
        cannot_write(path_, "it is being written, by this or another program");
    }
}

void StagedFile::appear() {
    require_open();
    require_replaceable();
    static_cast<void>(::flock(descriptor_, LOCK_EX | LOCK_NB));  // not every file system has locks
    if (!temporary_.empty() && ::rename(temporary_.c_str(), target_.c_str()) != 0) {
        fail(errno);
    }
    if (!temporary_.empty()) {
        temporary_ = target_;
    }
    appeared_ = true;
}

StagedFile::~StagedFile() {
    if (appeared_) {
        keep();
    } else {
        abandon();
    }
}

void StagedFile::keep() noexcept {
    close_descriptor();
    settled_ = true;
}

void StagedFile::abandon() noexcept {
    close_descriptor();
    if (!std::exchange(settled_, true) && !temporary_.empty()) {
        ::unlink(temporary_.c_str());
    }
}

/// @returns 0, or the errno of the failed call
int StagedFile::close_descriptor() noexcept {
    if (descriptor_ < 0 || ::close(std::exchange(descriptor_, -1)) == 0 || errno == EINTR) {
        return 0;
    }
    doubtful_ = true;
    return errno;
}

void StagedFile::fail(int reason) {
    failure_ = reason;
    refuse(path_, reason);
}

void StagedFile::require_open() const {
    if (failure_ != 0) {
        refuse(path_, failure_);
    }
    if (descriptor_ < 0) {
        throw std::logic_error("write to " + printable_whole(path_.string()) + " after its end");
    }
}

void StagedFile::close() {
    require_open();
    if (const int error = close_descriptor()) {
        fail(error);
    }
}

void StagedFile::commit() {
    if (descriptor_ >= 0 || settled_ || failure_ != 0) {
        close();
    }
    if (!temporary_.empty() && ::rename(temporary_.c_str(), target_.c_str()) != 0) {
        fail(errno);
    }
    settled_ = true;
}

int write_all(int descriptor, std::span<const std::byte> bytes) noexcept {
    return repeat(bytes, [&](std::span<const std::byte> left, std::size_t) {
        return ::write(descriptor, left.data(), left.size());
    });
}

int write_all_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t offset) noexcept {
    return repeat(bytes, [&](std::span<const std::byte> left, std::size_t done) {
        return ::pwrite(descriptor, left.data(), left.size(), static_cast<off_t>(offset + done));
    });
}

void cannot_write(const std::filesystem::path& path, std::string_view reason) {
    throw std::runtime_error(fmt::format("cannot write {}: {}", printable_whole(path.string()), reason));
}

}  // namespace hertzline::recordings
