#include "measures/resources.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string>

#include <sched.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "core/scene/text.hpp"

namespace hertzline::measures {
namespace fs = std::filesystem;
namespace {

/// The number that follows `key` in a file of "key number ..." lines; the first number of the file for an empty key.
std::optional<std::uint64_t> number_in(const fs::path& file, const std::string& key) {
    std::ifstream in(file);
    std::string word;
    while (key.empty() || in >> word) {
        if (key.empty() || word == key) {
            std::uint64_t number = 0;
            return in >> number ? std::optional(number) : std::nullopt;  // "max" is no number: no limit
        }
        in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    return std::nullopt;
}

/// Returns the memory that one control group leaves. Its page cache counts as used but is given back on demand.
std::optional<std::uint64_t> left_in_group(const fs::path& limit_file, const fs::path& usage_file,
                                           const fs::path& stat_file, const std::string& cache_key) {
    // Groups of the first version without a limit show its largest number.
    constexpr std::uint64_t no_limit = std::uint64_t{1} << 60;
    const auto limit = number_in(limit_file, "");
    if (!limit || *limit > no_limit) {
        return std::nullopt;
    }
    const auto usage = number_in(usage_file, "");
    if (!usage) {
        return std::nullopt;
    }
    const std::uint64_t cache = number_in(stat_file, cache_key).value_or(0);
    const std::uint64_t used = *usage - std::min(cache, *usage);
    return *limit - std::min(used, *limit);
}

std::optional<std::uint64_t> smaller(std::optional<std::uint64_t> a, std::optional<std::uint64_t> b) {
    return a && b ? std::min(*a, *b) : (a ? a : b);
}

/// Looks at a group and at all groups above it. In a container the group's own path may not be visible; the root of the hierarchy then is
/// the container's group.
template <class Look>
void look_up_the_tree(const fs::path& hierarchy, std::string_view group, const Look& look) {
    for (fs::path relative = fs::path(group).relative_path().lexically_normal();;
         relative = relative.parent_path()) {
        look(hierarchy / relative);
        if (relative.empty()) {
            return;
        }
    }
}

/// Looks at the folders of this process's control groups that have the controller. Returns whether they are of the second version.
/// Lines of /proc/self/cgroup: "0::/path" (v2) or "7:memory,other:/path" (v1), cgroups(7).
template <class Look>
void look_at_control_groups(const fs::path& root, const std::string& controller, const Look& look) {
    std::ifstream groups(root / "proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const auto first = line.find(':');
        const auto second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) {
            continue;
        }
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const std::string group = line.substr(second + 1);
        if (controllers == ",,") {
            look_up_the_tree(root / "sys/fs/cgroup", group, [&](const fs::path& d) { look(d, true); });
        } else if (controllers.find("," + controller + ",") != std::string::npos) {
            look_up_the_tree(root / "sys/fs/cgroup" / controller, group,
                             [&](const fs::path& d) { look(d, false); });
        }
    }
}

std::optional<std::uint64_t> left_by_control_groups(const fs::path& root) {
    std::optional<std::uint64_t> left;
    look_at_control_groups(root, "memory", [&](const fs::path& d, bool unified) {
        left = smaller(left, unified ? left_in_group(d / "memory.max", d / "memory.current",
                                                     d / "memory.stat", "inactive_file")
                                     : left_in_group(d / "memory.limit_in_bytes", d / "memory.usage_in_bytes",
                                                     d / "memory.stat", "total_inactive_file"));
    });
    return left;
}

/// Processors that a quota of time comes to, rounded up.
std::optional<std::uint64_t> processors_of(std::optional<std::uint64_t> quota,
                                           std::optional<std::uint64_t> period) {
    return quota && period && *period > 0
               ? std::optional(std::max<std::uint64_t>(1, *quota / *period + (*quota % *period != 0)))
               : std::nullopt;
}

std::optional<std::uint64_t> processors_in_group(const fs::path& group, bool unified) {
    if (!unified) {  // without a quota it is -1, which reads as the largest number
        return processors_of(number_in(group / "cpu.cfs_quota_us", ""),
                             number_in(group / "cpu.cfs_period_us", ""));
    }
    std::ifstream file(group / "cpu.max");  // "max 100000" or "150000 100000"
    std::uint64_t quota = 0;
    std::uint64_t period = 0;
    return file >> quota >> period ? processors_of(quota, period) : std::nullopt;
}

/// Processors that the system lets this process run on.
std::optional<std::uint64_t> processors_of_affinity() {
    for (int most = CPU_SETSIZE; most <= 1 << 16; most *= 2) {
        const std::unique_ptr<cpu_set_t, void (*)(cpu_set_t*)> set(CPU_ALLOC(static_cast<std::size_t>(most)),
                                                                   [](cpu_set_t* old) { CPU_FREE(old); });
        const std::size_t bytes = CPU_ALLOC_SIZE(static_cast<std::size_t>(most));
        if (set != nullptr && ::sched_getaffinity(0, bytes, set.get()) == 0) {
            return static_cast<std::uint64_t>(CPU_COUNT_S(bytes, set.get()));
        }
    }
    return std::nullopt;
}

/// Memory that a limit of the address space leaves for data, beside threads' stacks and the allocator's reserves.
std::optional<std::uint64_t> left_by_address_space() {
    constexpr std::uint64_t for_threads = 64 << 20;
    const auto left = address_space_left();
    return left ? std::optional(*left - std::min(*left, for_threads)) : std::nullopt;
}

bool fits(double needed, std::optional<std::uint64_t> available) {
    return std::isfinite(needed) && (!available || needed <= static_cast<double>(*available));
}

std::string amount(std::optional<std::uint64_t> available) {
    return available ? human_bytes(static_cast<double>(*available)) : "an unknown amount";
}

}  // namespace

std::optional<std::uint64_t> available_memory_bytes(const fs::path& root) {
    auto available = number_in(root / "proc/meminfo", "MemAvailable:");
    if (available) {
        *available *= 1024;
    }
    return smaller(smaller(available, left_by_control_groups(root)), left_by_address_space());
}

std::optional<std::uint64_t> address_space_left() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) {
        return std::nullopt;
    }
    const std::uint64_t pages = number_in("/proc/self/statm", "").value_or(0);
    const std::uint64_t used = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    return limit.rlim_cur - std::min<std::uint64_t>(used, limit.rlim_cur);
}

std::uint64_t descriptors_left() {
    rlimit limit{};
    ::getrlimit(RLIMIT_NOFILE, &limit);
    std::error_code error;
    const fs::directory_iterator open("/proc/self/fd", error);
    if (error) {
        return 0;  // it takes a descriptor itself
    }
    const auto used = static_cast<std::uint64_t>(std::distance(begin(open), end(open)));
    return limit.rlim_cur - std::min<std::uint64_t>(used, limit.rlim_cur);
}

std::optional<std::string> limit_shortage(std::string_view purpose, double address_bytes,
                                          std::uint64_t descriptors) {
    if (const auto left = address_space_left(); !fits(address_bytes, left)) {
        return std::string(purpose) + " needs " + human_bytes(address_bytes) +
               " of address space, the limit of this process (ulimit -v) leaves " + amount(left);
    }
    if (const std::uint64_t left = descriptors_left(); descriptors > left) {
        return std::string(purpose) + " needs " + std::to_string(descriptors) +
               " file descriptors, the limit of this process (ulimit -n) leaves " + std::to_string(left);
    }
    return std::nullopt;
}

int usable_processors(const fs::path& root) {
    std::optional<std::uint64_t> processors = processors_of_affinity();
    look_at_control_groups(root, "cpu", [&](const fs::path& group, bool unified) {
        processors = smaller(processors, processors_in_group(group, unified));
    });
    constexpr std::uint64_t most = 1 << 16;
    return static_cast<int>(std::clamp<std::uint64_t>(processors.value_or(1), 1, most));
}

std::optional<std::uint64_t> free_disk_bytes(const fs::path& path) {
    std::error_code error;
    if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
        return std::nullopt;
    }
    const fs::path target = fs::weakly_canonical(path, error);  // a link's target is where the bytes go
    const fs::path parent = (error ? path : target).parent_path();
    struct statvfs system {};
    if (::statvfs(parent.empty() ? "." : parent.c_str(), &system) != 0) {
        return std::nullopt;
    }
    return static_cast<std::uint64_t>(system.f_bavail) * system.f_frsize;
}

std::string human_bytes(double bytes) {
    constexpr std::array units{"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    std::size_t unit = 0;
    double number = bytes;
    while (number >= 1024 && unit + 1 < units.size()) {
        number /= 1024;
        ++unit;
    }
    std::array<char, 64> text{};
    if (!(number < 1024)) {
        std::snprintf(text.data(), text.size(), "%.1e bytes", bytes);
    } else if (unit == 0) {
        std::snprintf(text.data(), text.size(), "%.0f bytes", number);
    } else {
        std::snprintf(text.data(), text.size(), "%.1f %s", number, units[unit]);
    }
    return text.data();
}

std::optional<std::string> memory_shortage(std::string_view purpose, double needed_bytes,
                                           std::optional<std::uint64_t> available) {
    if (fits(needed_bytes, available)) {
        return std::nullopt;
    }
    return std::string(purpose) + " needs " + human_bytes(needed_bytes) + " of memory, " + amount(available) +
           " is available";
}

std::optional<std::string> disk_shortage(const fs::path& path, double needed_bytes,
                                         std::optional<std::uint64_t> available) {
    if (fits(needed_bytes, available)) {
        return std::nullopt;
    }
    return printable_whole(path.string()) + " needs " + human_bytes(needed_bytes) + " of disk, " +
           amount(available) + " is free";
}

std::optional<std::string> disk_shortage(const fs::path& path, double needed_bytes) {
    return disk_shortage(path, needed_bytes, free_disk_bytes(path));
}

}  // namespace hertzline::measures
