#include "recordings/files/write_all.hpp"

#include <cerrno>

#include <unistd.h>

namespace hertzline::recordings {

namespace {

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

}  // namespace hertzline::recordings
