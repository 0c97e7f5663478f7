// Loaded into the program (LD_PRELOAD) by the tests of faults, it lets them do from outside what they
// otherwise could not without touching the whole machine:
//     SIGUSR1   interrupts whatever system call waits, as the signals of profilers and debuggers do
//     SIGUSR2   sets the program's wall clock back by an hour
// The wall clock is read through the kernel itself, not through another library or a sanitizer.

#include <atomic>
#include <csignal>
#include <ctime>

#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

namespace {

std::atomic<time_t> shift_s{0};

void do_nothing(int /*signal*/) {}

void set_back(int /*signal*/) {
    shift_s -= 3600;
}

void on(int signal, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;  // without SA_RESTART: what waits returns with EINTR
    sigaction(signal, &action, nullptr);
}

[[gnu::constructor]] void listen_to_signals() {
    on(SIGUSR1, do_nothing);
    on(SIGUSR2, set_back);
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
    const auto status = static_cast<int>(syscall(SYS_clock_gettime, clock, time));
    if (status == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) {
        time->tv_sec += shift_s;
    }
    return status;
}

int gettimeofday(timeval* time, void* /*zone*/) noexcept {
    timespec now{};
    const int status = clock_gettime(CLOCK_REALTIME, &now);
    *time = {.tv_sec = now.tv_sec, .tv_usec = now.tv_nsec / 1000};
    return status;
}

time_t time(time_t* result) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (result != nullptr) {
        *result = now.tv_sec;
    }
    return now.tv_sec;
}

}  // extern "C"
