#pragma once
// The lines of a text file, device or pipe, each ended by LF, CR LF or CR.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hertzline::recordings {

/// A wait for a pipe that has no writer yet, or whose writer pauses, can be stopped. Errors are std::runtime_error that names the path.
class CsvLines {
public:
    /// @param stop true: the lines are at their end; null: never
    explicit CsvLines(const std::filesystem::path& path, const std::atomic<bool>* stop = nullptr);
    ~CsvLines();
    CsvLines(const CsvLines&) = delete;
    CsvLines& operator=(const CsvLines&) = delete;

    /// Whether the file can be read only once.
    bool is_pipe() const noexcept { return is_pipe_; }

    /// Goes to the next line. Returns false at the end and once stopped or interrupted.
    bool next();

    /// The present line, without its end and without the byte order mark of UTF-8.
    std::string_view line() const noexcept { return {buffer_.data() + begin_, line_size_}; }
    /// Whether the present line has an end; else the file stops within it, or behind it.
    bool is_ended() const noexcept { return is_ended_; }

    /// Throws the fault, with path and the present line's number.
    [[noreturn]] void fail(const std::string& fault) const;
    /// Returns path and number of the present line.
    std::string name() const;

    /// The end of a line.
    struct Place {
        std::int64_t byte;
        std::int64_t number;
    };
    Place place() const noexcept { return {read_ - static_cast<std::int64_t>(end_ - line_end_), number_}; }
    /// Goes back there. Not in pipes.
    void go_back(const Place& place);

    void interrupt() noexcept { interrupted_ = true; }
    bool stopped() const noexcept { return interrupted_ || (stop_ != nullptr && *stop_); }

private:
    void take(std::size_t end, std::size_t ending);
    std::size_t find_end(std::size_t from);
    void pass_byte_order_mark();
    bool fill();
    bool wait_for_writer() const;
    void close() noexcept;

    std::filesystem::path path_;
    const std::atomic<bool>* stop_;
    int descriptor_;
    bool is_pipe_ = false;
    char ending_ = 0;  // of lines; 0: not known yet
    bool is_ended_ = true;
    std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
    std::size_t begin_ = 0;  // of the line, in the buffer
    std::size_t line_size_ = 0;
    std::size_t line_end_ = 0;  // where the next line begins
    std::size_t end_ = 0;       // of the bytes that were read
    std::int64_t read_ = 0;     // bytes of the file
    std::int64_t number_ = 0;   // of the line
    std::atomic<bool> interrupted_{false};
};

}  // namespace hertzline::recordings
