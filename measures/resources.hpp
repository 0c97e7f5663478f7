#pragma once
// Free memory and disk, so that a run that does not fit is refused before it starts, in plain words.
// Needs are counted in double: 1e300 samples are a number too, and nothing wraps around.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace hertzline::measures {

/// Memory that this process may still take without swapping [bytes]: MemAvailable of /proc/meminfo, or less where a
/// control group (v2 or v1: a container, a systemd slice) or the limit of its address space (ulimit -v), less what threads
/// and libraries take, allows less. Absent when the system does not report it.
/// `root` is the root of the system's files.
std::optional<std::uint64_t> available_memory_bytes(const std::filesystem::path& root = "/");

/// Address space that the limit of this process leaves (ulimit -v) [bytes]; absent without a limit.
std::optional<std::uint64_t> address_space_left();

/// File descriptors that the limit of this process leaves (ulimit -n).
std::uint64_t descriptors_left();

/// Returns the shortage when `purpose` needs more than these limits leave: "a ZeroMQ socket needs 24 file descriptors, the
/// limit of this process (ulimit -n) leaves 9". Libraries end the program where they run out of either.
std::optional<std::string> limit_shortage(std::string_view purpose, double address_bytes,
                                          std::uint64_t descriptors);

/// Processors that this process may use at a time, at least 1: those of its affinity, or fewer where the quota of a control
/// group (v2 or v1) allows fewer; a part of one counts as one. `root` as above.
int usable_processors(const std::filesystem::path& root = "/");

/// Returns the space for a file of that name [bytes]: the free space of its directory's file system for ordinary
/// users. Absent for a device or a FIFO, and when the system does not report it.
std::optional<std::uint64_t> free_disk_bytes(const std::filesystem::path& path);

/// "512 bytes", "1.5 GiB", "8.0e+300 bytes".
std::string human_bytes(double bytes);

/// Returns the shortage when `purpose` ("recording v_out") needs more memory than is available: "recording v_out needs 7.5 TiB of
/// memory, 22.3 GiB is available". Absent when it fits, or when the available memory is unknown; a need that
/// is not a number or is infinite never fits.
std::optional<std::string> memory_shortage(std::string_view purpose, double needed_bytes,
                                           std::optional<std::uint64_t> available = available_memory_bytes());

/// Returns the shortage of disk for a file: "out.csv needs 7.5 TiB of disk, 22.3 GiB is free".
std::optional<std::string> disk_shortage(const std::filesystem::path& path, double needed_bytes,
                                         std::optional<std::uint64_t> available);
std::optional<std::string> disk_shortage(const std::filesystem::path& path, double needed_bytes);

}  // namespace hertzline::measures
