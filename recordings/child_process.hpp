#pragma once
// Work in a process of its own, because it may crash, hang or take all memory. It answers through a pipe, one way.

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include <sys/types.h>

namespace hertzline::recordings {

/// Limits of a child.
struct ChildLimits {
    double memory_bytes = 4.0 * 1024 * 1024 * 1024;  ///< address space beyond the parent's
    std::chrono::seconds processor{30};              ///< time between two answers
    /// The time for which the parent waits for an answer. Unset: for ever, for work that itself waits.
    std::optional<std::chrono::milliseconds> silence = std::chrono::seconds(60);
};

/// The child's end of the pipe.
class Answers {
public:
    Answers(int descriptor, std::chrono::seconds processor);
    /// Waits for the parent. Ends the child when the parent is gone.
    void write(std::span<const std::byte> bytes);

private:
    void renew_processor_time() const;

    int descriptor_;
    std::chrono::seconds processor_;
};

/// A child process, and the parent's end of the pipe. The child has no descriptor but the pipe, and its standard streams
/// are /dev/null. It leaves no core dump, and ends soon after its parent. Ctrl-C and SIGTERM are left to the parent. It
/// is no sandbox: its rights are the user's.
class ChildProcess {
public:
    using Work = std::function<void(Answers&)>;

    /// Forks; the child does the work, ends when it returns or throws, and never comes back from here. No other thread
    /// may hold a lock meanwhile that the work needs. @throws std::system_error
    ChildProcess(const Work& work, const ChildLimits& limits);
    /// Ends the child.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Fills `bytes` with the child's next answer. Returns false once interrupted. @throws std::runtime_error with
    /// the child's fate when it ends early or stays silent too long
    bool read(std::span<std::byte> bytes);
    /// Makes read() return within 50 ms; from another thread.
    void interrupt() noexcept { interrupted_ = true; }

private:
    bool wait_for_bytes() const;
    std::string end_of_child();

    ChildLimits limits_;
    int answers_ = -1;
    pid_t child_ = -1;
    std::atomic<bool> interrupted_{false};
};

}  // namespace hertzline::recordings
