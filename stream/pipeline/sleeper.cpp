#include "stream/pipeline/sleeper.hpp"

#include <cerrno>
#include <ctime>

namespace hertzline::stream {

Sleeper::Sleeper() noexcept : wake_() {
    sem_init(&wake_, /*pshared=*/0, /*value=*/0);
}

Sleeper::~Sleeper() {
    sem_destroy(&wake_);
}

/// Leaves the core's execution units to the other thread on it.
void Sleeper::pause() noexcept {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

bool Sleeper::sleep(Nanoseconds deadline) noexcept {
    const timespec time{.tv_sec = deadline.count() / 1'000'000'000,
                        .tv_nsec = deadline.count() % 1'000'000'000};
    return sem_clockwait(&wake_, CLOCK_MONOTONIC, &time) == 0 || errno != ETIMEDOUT;
}

}  // namespace hertzline::stream
