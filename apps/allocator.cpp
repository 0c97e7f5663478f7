// How the program's allocator is set. A subscriber that does not read leaves hundreds of MiB of frames
// behind. glibc keeps such memory for itself: any block above it in the heap holds it, and its
// malloc_trim() stops the sending thread for 0.3 s. jemalloc gives it back within seconds,
// from a thread of its own.

#include "apps/allocator.hpp"

#include <cstddef>

// NOLINTNEXTLINE(cppcoreguidelines-*,misc-definitions-in-headers): the name under which jemalloc looks for it
extern "C" const char* malloc_conf;
const char* malloc_conf = "dirty_decay_ms:1000,muzzy_decay_ms:0";

// Of jemalloc; not there where sanitizers bring an allocator of their own.
extern "C" [[gnu::weak]] int mallctl(const char* name, void* old, std::size_t* old_size, void* value,
                                     std::size_t size);

void hertzline::app::start_allocator_thread() noexcept {
    bool wanted = true;
    if (mallctl != nullptr) {
        mallctl("background_thread", nullptr, nullptr, &wanted, sizeof wanted);
    }
}
