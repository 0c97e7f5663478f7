#pragma once
// Counts heap allocations, to test that a loop makes none.

#include <cstddef>

// Sanitizers bring an allocator of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HERTZLINE_ALLOCATIONS_ARE_COUNTED 0
#else
#define HERTZLINE_ALLOCATIONS_ARE_COUNTED 1
#endif

namespace hertzline::test {

/// Returns the allocations by this thread since it started, direct or indirect calls of malloc; always 0 under sanitizers.
std::size_t allocations() noexcept;

/// Counts the allocations of any thread of that name (at most 15 characters) while it lives; one at a time.
class AllocationsOfThread {
public:
    explicit AllocationsOfThread(const char* name) noexcept;
    ~AllocationsOfThread();
    AllocationsOfThread(const AllocationsOfThread&) = delete;
    AllocationsOfThread& operator=(const AllocationsOfThread&) = delete;
    std::size_t so_far() const noexcept;
};

}  // namespace hertzline::test
