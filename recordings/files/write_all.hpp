#pragma once
// Writing to a descriptor to the end: a system call may take a part only, or be interrupted.

#include <cstddef>
#include <cstdint>
#include <span>

namespace hertzline::recordings {

/// Writes all bytes where the file stands. @returns 0, or the errno of the call that failed.
[[nodiscard]] int write_all(int descriptor, std::span<const std::byte> bytes) noexcept;

/// Writes all bytes from `offset` [bytes] on; where the file stands does not change. @returns the same.
[[nodiscard]] int write_all_at(int descriptor, std::span<const std::byte> bytes,
                               std::uint64_t offset) noexcept;

}  // namespace hertzline::recordings
