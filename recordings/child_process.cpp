#include "recordings/child_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hertzline::recordings {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds glance{50};         // between looks at the flag of interruption
constexpr milliseconds longest_end{1000};  // for a killed child to end: one that waits for a disk cannot

[[noreturn]] void fail(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
}

// In a child.
pid_t parent = 0;
bool of_main_thread = false;  // made by the parent's first thread, which ends with it

extern "C" void end_without_parent(int /*signal*/) {
    if (::getppid() != parent) {
        ::_exit(1);
    }
}

void handle(int signal, void (*how)(int)) {
    struct sigaction action {};
    action.sa_handler = how;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
}

/// Removes the parent's handlers in the child. The parent decides on signals that a terminal sends to both.
void reset_signals() {
    for (int signal = 1; signal < NSIG; ++signal) {
        handle(signal, SIG_DFL);
    }
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
        handle(signal, SIG_IGN);
    }
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Ends the child with its parent, at once where the system signals it, because bytes that the child still takes from
/// a pipe are lost to the next reader. It also polls, since the parent may have ended before the signal was set.
void end_with_parent() {
    handle(SIGALRM, end_without_parent);
    ::prctl(PR_SET_PDEATHSIG,
            of_main_thread ? SIGKILL : SIGALRM);  // when the thread that made the child ends
    constexpr itimerval twice_a_second{.it_interval = {0, 500'000}, .it_value = {0, 500'000}};
    ::setitimer(ITIMER_REAL, &twice_a_second, nullptr);
}

/// @returns the number that `kept` has now
int close_all_but(int kept) {
    kept = ::fcntl(kept, F_DUPFD, STDERR_FILENO + 1);
    const int null = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        ::dup2(null, stream);
    }
    const auto number = static_cast<unsigned>(kept);
    if (number > STDERR_FILENO + 1) {
        ::close_range(STDERR_FILENO + 1, number - 1, 0);
    }
    ::close_range(number + 1, ~0U, 0);
    return kept;
}

/// Limits memory beyond the present size: sanitizers reserve terabytes.
void limit_memory(double bytes) {
    std::ifstream sizes("/proc/self/statm");
    double pages = 0;
    if (sizes >> pages) {
        const auto most = static_cast<rlim_t>(pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) + bytes);
        const rlimit limit{most, most};
        ::setrlimit(RLIMIT_AS, &limit);
    }
    std::ofstream("/proc/self/oom_score_adj") << 1000;  // the first to go where memory runs out
}

[[noreturn]] void be_child(const ChildProcess::Work& work, const ChildLimits& limits, int pipe) noexcept {
    reset_signals();
    end_with_parent();
    pipe = close_all_but(pipe);
    limit_memory(limits.memory_bytes);
    ::prctl(PR_SET_DUMPABLE, 0);  // no core dump
    try {
        Answers answers(pipe, limits.processor);
        work(answers);
    } catch (...) {
        ::_exit(1);
    }
    ::_exit(0);  // exit handlers are the parent's
}

}  // namespace

Answers::Answers(int descriptor, std::chrono::seconds processor)
    : descriptor_(descriptor), processor_(processor) {
    renew_processor_time();
}

void Answers::renew_processor_time() const {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    rlimit limit{};
    ::getrlimit(RLIMIT_CPU, &limit);
    // Whole seconds of the sum: of 0.9 s in user mode and 0.9 s in the kernel one is full.
    const auto seconds = used.ru_utime.tv_sec + used.ru_stime.tv_sec +
                         (used.ru_utime.tv_usec + used.ru_stime.tv_usec) / 1'000'000;
    limit.rlim_cur = std::min<rlim_t>(static_cast<rlim_t>(seconds + 1 + processor_.count()), limit.rlim_max);
    ::setrlimit(RLIMIT_CPU, &limit);  // beyond it comes SIGXCPU
}

void Answers::write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR) {
            ::_exit(1);
        }
        bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(0, written)));
    }
    renew_processor_time();
}

ChildProcess::ChildProcess(const Work& work, const ChildLimits& limits) : limits_(limits) {
    constexpr int pipe_bytes = 1 << 20;
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
        fail("a pipe to a child process");
    }
    ::fcntl(ends[0], F_SETPIPE_SZ, pipe_bytes);  // or what the system allows
    // A signal that comes while the child still has the parent's handlers would count as the parent's.
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    const pid_t self = ::getpid();
    const bool in_main_thread = ::gettid() == self;
    child_ = ::fork();
    if (child_ == 0) {
        parent = self;
        of_main_thread = in_main_thread;
        be_child(work, limits, ends[1]);
    }
    const int reason = errno;
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    ::close(ends[1]);
    answers_ = ends[0];
    if (child_ < 0) {
        ::close(answers_);
        errno = reason;
        fail("a child process");
    }
}

ChildProcess::~ChildProcess() {
    ::close(answers_);
    if (child_ > 0) {
        ::kill(child_, SIGKILL);
        for (milliseconds waited{0}; ::waitpid(child_, nullptr, WNOHANG) == 0 && waited < longest_end;
             ++waited) {
            std::this_thread::sleep_for(milliseconds(1));
        }
    }
}

/// False once interrupted.
bool ChildProcess::wait_for_bytes() const {
    // In glances, not by the clock: a parent that was stopped for a while has not waited.
    for (milliseconds waited{0}; !interrupted_; waited += glance) {
        if (limits_.silence && waited > *limits_.silence) {
            throw std::runtime_error(
                fmt::format("the process that reads it has been silent for {} ms", limits_.silence->count()));
        }
        pollfd answers{.fd = answers_, .events = POLLIN, .revents = 0};
        if (::poll(&answers, 1, static_cast<int>(glance.count())) > 0) {
            return true;
        }
    }
    return false;
}

bool ChildProcess::read(std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        if (!wait_for_bytes()) {
            return false;
        }
        const ssize_t got = ::read(answers_, bytes.data(), bytes.size());
        if (got == 0) {
            throw std::runtime_error(end_of_child());
        }
        if (got < 0 && errno != EINTR) {
            fail("reading from a child process");
        }
        bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    }
    return true;
}

/// Once it has closed its end of the pipe.
std::string ChildProcess::end_of_child() {
    int status = 0;
    const bool known = child_ > 0 && ::waitpid(child_, &status, 0) == child_;
    child_ = -1;
    if (known && WIFSIGNALED(status)) {
        const int signal = WTERMSIG(status);
        return signal == SIGXCPU
                   ? fmt::format("the process that reads it took more than {} s", limits_.processor.count())
                   : fmt::format("the process that reads it crashed: {}", ::sigdescr_np(signal));
    }
    return fmt::format("the process that reads it ended in the midst, with exit status {}",
                       known ? WEXITSTATUS(status) : -1);
}

}  // namespace hertzline::recordings
