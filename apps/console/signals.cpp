#include "apps/console/signals.hpp"

#include <csignal>
#include <string_view>

#include <poll.h>
#include <unistd.h>

namespace hertzline::app {

namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");

std::atomic<bool> at_once{false};

/// Says so where stderr takes it without waiting; of the functions that a signal handler may call.
void say_stopped() noexcept {
    constexpr std::string_view text = "error: stopped\n";
    pollfd err{STDERR_FILENO, POLLOUT, 0};
    if (::poll(&err, 1, 0) == 1 && (err.revents & POLLOUT) != 0) {
        [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
    }
}

extern "C" void note_stop(int /*signal*/) {
    if (at_once.load(std::memory_order_relaxed)) {
        say_stopped();
        ::_exit(1);
    }
    stop.store(true, std::memory_order_relaxed);
}

/// Catches the signal even if it was ignored: a shell starts its background jobs with SIGINT ignored, but a user who
/// sends it wants the job to end.
void catch_signal(int signal) {
    struct sigaction action {};
    action.sa_handler = note_stop;
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
}

/// Catches the signal unless nohup(1) had it ignored.
void catch_unless_ignored(int signal) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) {
        catch_signal(signal);
    }
}

void catch_signals() {
    catch_signal(SIGINT);
    catch_signal(SIGTERM);
    catch_unless_ignored(SIGHUP);
}

}  // namespace

void end_at_once_when_asked() {
    at_once.store(true, std::memory_order_relaxed);
    catch_signals();
}

void note_when_asked() noexcept {
    at_once.store(false, std::memory_order_relaxed);
}

const std::atomic<bool>& stop_asked() {
    static const bool caught = [] {
        at_once.store(false, std::memory_order_relaxed);
        catch_signals();
        return true;
    }();
    (void)caught;
    return stop;
}

bool stop_was_asked() noexcept {
    return stop.load(std::memory_order_relaxed);
}

}  // namespace hertzline::app
