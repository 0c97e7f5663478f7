// How the program's allocator is set. A subscriber that does not read leaves hundreds of MiB of frames
// behind. glibc keeps such memory for itself: any block above it in the heap holds it, and its
// malloc_trim() stops the sending thread for 0.3 s. jemalloc gives it back within seconds,
// from a thread of its own.

// NOLINTNEXTLINE(cppcoreguidelines-*,misc-definitions-in-headers): the name under which jemalloc looks for it
extern "C" const char* malloc_conf;
const char* malloc_conf = "background_thread:true,dirty_decay_ms:1000,muzzy_decay_ms:0";
