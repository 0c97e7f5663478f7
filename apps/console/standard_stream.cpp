#include "apps/console/standard_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/console/signals.hpp"

namespace hertzline::app {

namespace {

constexpr int wait_ms = 100;  // between looks at the stop flag, and for a reader after it

/// Opens a terminal or pipe a second time. A file would be opened at its start.
int reopen_without_blocking(int descriptor) noexcept {
    struct stat status {};
    const int flags = ::fcntl(descriptor, F_GETFL);
    const bool writable = flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
    if (!writable || ::fstat(descriptor, &status) != 0 ||
        !(S_ISFIFO(status.st_mode) || ::isatty(descriptor) == 1)) {
        return -1;
    }
    const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
    return ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
}

}  // namespace

StandardStream::StandardStream(int descriptor) noexcept
    : descriptor_(descriptor), reopened_(reopen_without_blocking(descriptor)) {}

StandardStream::~StandardStream() {
    if (reopened_ >= 0) {
        ::close(reopened_);
    }
}

bool StandardStream::has_room(int wait_ms) const noexcept {
    pollfd asked{.fd = reopened_ >= 0 ? reopened_ : descriptor_, .events = POLLOUT, .revents = 0};
    return ::poll(&asked, 1, wait_ms) != 0;  // an error is the next write's
}

int StandardStream::write_some(std::string_view& text) noexcept {
    while (!text.empty()) {
        if (!has_room(0)) {
            return EAGAIN;
        }
        // If there is room at all, that many bytes fit without blocking (pipe(7)).
        const std::size_t part = std::min<std::size_t>(text.size(), PIPE_BUF);
        const ssize_t written = ::write(reopened_ >= 0 ? reopened_ : descriptor_, text.data(), part);
        if (written >= 0) {
            text.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno != EINTR) {
            return errno;
        }
    }
    return 0;
}

int StandardStream::write(std::string_view text) noexcept {
    for (;;) {
        const int error = write_some(text);
        if (error != EAGAIN) {
            return error;
        }
        const bool last_wait = stop_was_asked();
        if (!has_room(wait_ms) && last_wait) {
            return EAGAIN;
        }
    }
}

}  // namespace hertzline::app
