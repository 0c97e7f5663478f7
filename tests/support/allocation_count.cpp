#include "tests/support/allocation_count.hpp"

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>

#include <sys/prctl.h>

namespace {

thread_local std::size_t count = 0;
std::atomic<const char*> watched{nullptr};
std::atomic<std::size_t> watched_count{0};

[[maybe_unused]] void note_allocation() noexcept {
    ++count;
    if (const char* name = watched.load()) {
        std::array<char, 16> own{};
        prctl(PR_GET_NAME, own.data());
        if (std::strcmp(own.data(), name) == 0) {
            ++watched_count;
        }
    }
}

}  // namespace

namespace hertzline::test {

std::size_t allocations() noexcept {
    return count;
}

AllocationsOfThread::AllocationsOfThread(const char* name) noexcept {
    watched_count = 0;
    watched = name;
}
AllocationsOfThread::~AllocationsOfThread() {
    watched = nullptr;
}
std::size_t AllocationsOfThread::so_far() const noexcept {
    return watched_count;
}

}  // namespace hertzline::test

#if HERTZLINE_ALLOCATIONS_ARE_COUNTED

// operator new, Eigen and the C library all call these.
// glibc has its own functions under the names below.
extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT
void* __libc_calloc(std::size_t, std::size_t);    // NOLINT
void* __libc_realloc(void*, std::size_t);         // NOLINT
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT

void* malloc(std::size_t size) {
    note_allocation();
    return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
    note_allocation();
    return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
    note_allocation();
    return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    note_allocation();
    return __libc_memalign(alignment, size);
}
}

#endif
