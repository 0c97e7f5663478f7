#pragma once
// Counts heap allocations of the calling thread, to test that a loop makes none.

#include <cstddef>

// Sanitizers bring an allocator of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HERTZLINE_ALLOCATIONS_ARE_COUNTED 0
#else
#define HERTZLINE_ALLOCATIONS_ARE_COUNTED 1
#endif

namespace hertzline::test {

/// Allocations by this thread since it started, by malloc or whatever calls it; always 0 under sanitizers.
std::size_t allocations() noexcept;

}  // namespace hertzline::test
