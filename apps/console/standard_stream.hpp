#pragma once
// Standard output and standard error. Whoever does not read them (a paused terminal, a full pipe) delays the program
// no longer than it likes, and a terminal that is gone is no more than an error.

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

    /// Writes what there is room for and takes it from `text`. @returns 0, or errno: EAGAIN when nobody reads
    int write_some(std::string_view& text) noexcept;

    /// Writes all. Waits for the reader until the user asks to stop, then for a moment. @returns the same
    int write(std::string_view text) noexcept;

private:
    bool has_room(int wait_ms) const noexcept;

    int descriptor_;
    int reopened_ =
        -1;  // the same without blocking, which does not show in other programs that share the stream
};

}  // namespace hertzline::app
