#pragma once
// Progress on a terminal: one line on stderr that is overwritten. Nothing is shown elsewhere.

#include <chrono>
#include <optional>
#include <string>

namespace hertzline::app {

/// One line on the terminal that is written over.
class ProgressLine {
public:
    ProgressLine();
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    bool is_on_terminal() const noexcept { return terminal_; }

    /// Whether there is a terminal and the line is old enough to be updated.
    bool due() const noexcept;

    void show(const std::string& text);

    /// Takes the line away, so that a message can be written.
    void clear() noexcept;

private:
    bool terminal_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_;
};

/// The progress of a run.
struct Progress {
    double simulated_s = 0;
    std::optional<double> goal_s;  ///< unset: until stopped
    double wall_s = 0;             ///< since the start
};

/// Returns " 42 %  210 us of 500 us simulated, 3.1 x real time, 12 s left"
std::string progress_text(const Progress& progress);

/// Returns "210 us", "12.3 s", "2 h 5 min"
std::string time_text(double seconds);

}  // namespace hertzline::app
