#include "tests/support/allocation_count.hpp"

#include <cstdlib>

namespace {

thread_local std::size_t count = 0;

}  // namespace

namespace hertzline::test {

std::size_t allocations() noexcept {
    return count;
}

}  // namespace hertzline::test

#if HERTZLINE_ALLOCATIONS_ARE_COUNTED

// operator new, Eigen and the C library all come through here; glibc keeps its own functions under these
// names.
extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT
void* __libc_calloc(std::size_t, std::size_t);    // NOLINT
void* __libc_realloc(void*, std::size_t);         // NOLINT
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT

void* malloc(std::size_t size) {
    ++count;
    return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
    ++count;
    return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
    ++count;
    return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    ++count;
    return __libc_memalign(alignment, size);
}
}

#endif
