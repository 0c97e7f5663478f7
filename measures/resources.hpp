#pragma once
// What the machine can still take, so that a run that cannot fit is refused before it starts, in plain words.
// Wishes are counted in double: 1e300 samples are a number too, and nothing wraps around.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace hertzline::measures {

/// Memory that this process may still take without swapping [bytes]: MemAvailable of /proc/meminfo, or less
/// where a control group (v2 or v1: a container, a systemd slice) allows less. Absent when the system does
/// not say. `root` is where the system's files are found.
std::optional<std::uint64_t> available_memory_bytes(const std::filesystem::path& root = "/");

/// Processors that this process may use at a time, at least 1: those of its affinity, or fewer where the quota of a control group (v2 or
/// v1) comes to fewer; a part of one counts as one. `root` as above.
int usable_processors(const std::filesystem::path& root = "/");

/// Space that a file of that name could take [bytes]: what the file system of its directory has free for
/// ordinary users. Absent when the path is not a file's (a device, a FIFO) or the directory cannot be asked.
std::optional<std::uint64_t> free_disk_bytes(const std::filesystem::path& path);

/// "512 bytes", "1.5 GiB", "8.0e+300 bytes".
std::string human_bytes(double bytes);

/// Why `purpose` ("recording v_out") cannot have `needed_bytes` of memory: "recording v_out needs 7.5 TiB of
/// memory, 22.3 GiB is available". Absent when it can, or when nothing is known of what there is; a need that
/// is not a number or is infinite never fits.
std::optional<std::string> memory_shortage(std::string_view purpose, double needed_bytes,
                                           std::optional<std::uint64_t> available = available_memory_bytes());

/// The same for a file: "out.csv needs 7.5 TiB of disk, 22.3 GiB is free".
std::optional<std::string> disk_shortage(const std::filesystem::path& path, double needed_bytes,
                                         std::optional<std::uint64_t> available);
std::optional<std::string> disk_shortage(const std::filesystem::path& path, double needed_bytes);

}  // namespace hertzline::measures
