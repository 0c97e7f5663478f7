// Disturbs the program from outside without touching the whole machine. The tests of faults load it by LD_PRELOAD:
//     SIGUSR1   interrupts waiting system calls, as the signals of profilers and debuggers do
//     SIGUSR2   sets the program's wall clock back by an hour
//     HERTZLINE_LOSES=PATH   closing a written file whose path begins with PATH fails, and half of it is lost, as
//                            over a network (NFS), where a full disk may show only then
// The wall clock is read through the kernel itself, not through another library or a sanitizer.

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
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
    action.sa_handler = handler;  // without SA_RESTART: waiting calls return with EINTR
    sigaction(signal, &action, nullptr);
}

std::atomic<ino_t> last_lost{0};

/// Returns whether this is a written file whose path begins with HERTZLINE_LOSES. The system reports an error once.
bool is_to_be_lost(int descriptor) {
    const char* const begin = std::getenv("HERTZLINE_LOSES");
    struct stat now {};
    if (begin == nullptr || (::fcntl(descriptor, F_GETFL) & O_ACCMODE) == O_RDONLY ||
        ::fstat(descriptor, &now) != 0 || now.st_size == 0 || last_lost == now.st_ino) {
        return false;
    }
    std::array<char, 4096> path{};
    const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
    const ssize_t length = ::readlink(link.c_str(), path.data(), path.size());
    return length > 0 && std::string_view(path.data(), static_cast<std::size_t>(length)).starts_with(begin);
}

void lose_half(int descriptor) {
    struct stat now {};
    if (::fstat(descriptor, &now) == 0) {
        [[maybe_unused]] const int failed = ::ftruncate(descriptor, now.st_size / 2);
        last_lost = now.st_ino;
    }
}

int (*next_close)(int) =
    nullptr;  // the system library's, or a sanitizer's; looked up when allocating is safe

[[gnu::constructor]] void begin() {
    next_close = reinterpret_cast<int (*)(int)>(::dlsym(RTLD_NEXT, "close"));
    on(SIGUSR1, do_nothing);
    on(SIGUSR2, set_back);
}

}  // namespace

extern "C" {

int close(int descriptor) {
    if (next_close == nullptr) {
        return static_cast<int>(syscall(SYS_close, descriptor));
    }
    const bool lost = is_to_be_lost(descriptor);
    if (lost) {
        lose_half(descriptor);
    }
    const int status = next_close(descriptor);
    if (lost) {
        errno = EIO;
    }
    return lost ? -1 : status;
}

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
