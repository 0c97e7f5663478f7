#include "apps/console/progress.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/console/messages.hpp"

namespace hertzline::app {

namespace {
using std::chrono::steady_clock;
constexpr auto period = std::chrono::milliseconds(200);
}  // namespace

ProgressLine::ProgressLine() : terminal_(stderr_is_terminal()), last_(steady_clock::now()) {}

bool ProgressLine::due() const noexcept {
    return terminal_ && steady_clock::now() - last_ >= period;
}

void ProgressLine::show(const std::string& text) {
    if (terminal_) {
        write_if_read("\r" + text + "\x1b[K");
        shown_ = true;
        last_ = steady_clock::now();
    }
}

void ProgressLine::clear() noexcept {
    if (shown_) {
        write_message("\r\x1b[K");
        shown_ = false;
    }
}

std::string progress_text(const Progress& progress) {
    const double factor = progress.wall_s > 0 ? progress.simulated_s / progress.wall_s : 0;
    const std::string speed = fmt::format("{:.3g} x real time", factor);
    if (!progress.goal_s) {
        return fmt::format("{} simulated, {}", time_text(progress.simulated_s), speed);
    }
    const double done = *progress.goal_s > 0 ? progress.simulated_s / *progress.goal_s : 1;
    const double left = factor > 0 ? (*progress.goal_s - progress.simulated_s) / factor : INFINITY;
    return fmt::format("{:3.0f} %  {} of {} simulated, {}, {} left", 100 * std::min(done, 1.0),
                       time_text(progress.simulated_s), time_text(*progress.goal_s), speed, time_text(left));
}

std::string time_text(double seconds) {
    if (!std::isfinite(seconds)) {
        return "unknown time";
    }
    if (seconds < 1e-3) {
        return fmt::format("{:.3g} us", seconds * 1e6);
    }
    if (seconds < 1) {
        return fmt::format("{:.3g} ms", seconds * 1e3);
    }
    if (seconds < 120) {
        return fmt::format("{:.3g} s", seconds);
    }
    const double minutes = std::floor(seconds / 60);
    if (minutes < 120) {
        return fmt::format("{:.0f} min {:.0f} s", minutes, std::floor(seconds - 60 * minutes));
    }
    return fmt::format("{:.0f} h {:.0f} min", std::floor(minutes / 60),
                       minutes - 60 * std::floor(minutes / 60));
}

}  // namespace hertzline::app
