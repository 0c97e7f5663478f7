#pragma once
// Standard output and standard error. A reader that pauses (a paused terminal, a full pipe) delays the program only
// as long as it permits, and a terminal that is gone is only an error.

#include <string>
#include <string_view>

namespace hertzline::app {

/// A standard stream. For one thread.
class StandardStream {
public:
    /// @param descriptor STDOUT_FILENO or STDERR_FILENO; stays open
    explicit StandardStream(int descriptor) noexcept;
    ~StandardStream();
    StandardStream(const StandardStream&) = delete;
    StandardStream& operator=(const StandardStream&) = delete;

    /// Writes as much as there is room for and removes it from `text`. @returns 0, or errno: EAGAIN without a reader
    int write_some(std::string_view& text) noexcept;

    /// Writes all. Waits for the reader until the user asks to stop, then for a moment. @returns 0, or errno
    int write(std::string_view text) noexcept;

private:
    bool has_room(int wait_ms) const noexcept;

    int descriptor_;
    int reopened_ = -1;  // the same, non-blocking without an effect on other programs that share the stream
};

}  // namespace hertzline::app
