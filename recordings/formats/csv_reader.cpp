#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/columns.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/csv.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_line = std::size_t{1} << 29;  // 20 million numbers, as of the longest chain
constexpr std::uint64_t largest_metadata = 64 << 20;
constexpr std::size_t rows_of_a_pipe = 16;  // at a time: few, as they may come slowly
constexpr double max_samples = 5e14;        // times up to there distinguish samples
constexpr double max_rounding = 0.25;       // of a sample, in such a time

/// Rounds a rate to that many digits. Rates are seldom crooked.
double rounded(double rate, int digits) {
    double result = 0;
    const std::string text = fmt::format("{:.{}g}", rate, digits);
    std::from_chars(text.data(), text.data() + text.size(), result);
    return result;
}

/// Returns the rate with the fewest digits at which all times are whole numbers of samples, bit for bit; for rounded
/// times the rate that follows from the first and the last. @param times increasing @returns 0 if they do not
double rate_of(std::vector<double> times) {
    if (times.size() < 2) {
        return 1;  // a single sample has no rate
    }
    double rate = 1 / (times[1] - times[0]);
    for (std::size_t i = 2; i < times.size(); ++i) {  // the farther the finer
        const double since = times[i] - times[0];
        const double samples = std::round(since * rate);
        if (std::abs(since * rate - samples) > max_rounding) {
            times.resize(i);  // the next line is no sample, which the reader reports
            break;
        }
        rate = samples / since;
    }
    for (int digits = 1; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
        const double candidate = rounded(rate, digits);
        const bool exact = candidate > 0 && std::ranges::all_of(times, [candidate](double time) {
                               return std::round(time * candidate) / candidate == time;
                           });
        if (exact && std::abs(candidate - rate) < 0.1 * rate) {
            return candidate;
        }
    }
    return rounded(rate, 9);
}

/// The lines of a file, device or pipe. A wait for a pipe whose writer pauses can be interrupted.
class Lines {
public:
    explicit Lines(const fs::path& path)
        : path_(path), descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY)) {
        struct stat status {};
        if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0 || S_ISDIR(status.st_mode)) {
            close();
            cannot_read(path, "not a file");
        }
        is_pipe_ = !S_ISREG(status.st_mode);
    }
    ~Lines() { close(); }
    Lines(const Lines&) = delete;
    Lines& operator=(const Lines&) = delete;

    /// Whether the file can be read only once.
    bool is_pipe() const noexcept { return is_pipe_; }

    /// Goes to the next line. Returns false at the end and once interrupted.
    bool next() {
        begin_ = line_end_;
        for (std::size_t searched = begin_;;) {
            const std::size_t found = std::string_view(buffer_.data() + searched, end_ - searched).find('\n');
            if (found != std::string_view::npos) {
                return take(searched + found, 1);
            }
            searched = end_ - begin_;
            std::memmove(buffer_.data(), buffer_.data() + begin_, searched);
            begin_ = line_size_ = line_end_ = 0;
            end_ = searched;
            if (!fill()) {
                return !interrupted_ && end_ > 0 && take(end_, 0);
            }
        }
    }

    /// The present line, without its end.
    std::string_view line() const noexcept { return {buffer_.data() + begin_, line_size_}; }

    /// Throws the fault, with path and the present line's number.
    [[noreturn]] void fail(const std::string& fault) const {
        throw std::runtime_error(
            fmt::format("{}:{}: {}", path_.string(), std::max<std::int64_t>(1, number_), fault));
    }

    /// The end of a line.
    struct Place {
        std::int64_t byte;
        std::int64_t number;
    };
    Place place() const noexcept { return {read_ - static_cast<std::int64_t>(end_ - line_end_), number_}; }
    /// Goes back there. Not in pipes.
    void go_back(const Place& place) {
        if (::lseek(descriptor_, place.byte, SEEK_SET) != place.byte) {
            cannot_read(path_, std::generic_category().message(errno));
        }
        read_ = place.byte;
        number_ = place.number;
        begin_ = line_end_ = line_size_ = end_ = 0;
    }

    void interrupt() noexcept { interrupted_ = true; }
    bool interrupted() const noexcept { return interrupted_; }

private:
    bool take(std::size_t end, std::size_t ending) {
        line_size_ = end - begin_;
        line_end_ = end + ending;
        line_size_ -= line().ends_with('\r') ? 1 : 0;
        ++number_;
        return true;
    }

    /// Reads more behind the bytes that are there. Returns false at the end and once interrupted.
    bool fill() {
        if (end_ == buffer_.size()) {
            const bool too_long = end_ >= longest_line;
            if (too_long || std::memchr(buffer_.data(), 0, end_) != nullptr) {
                ++number_;
                fail(too_long ? "the line is too long" : "found a byte 0, allowed: text");
            }
            buffer_.resize(2 * end_);
        }
        while (!is_pipe_ || wait_for_writer()) {
            const ssize_t got = ::read(descriptor_, buffer_.data() + end_, buffer_.size() - end_);
            if (got < 0 && errno == EINTR) {
                continue;
            }
            if (got < 0) {
                cannot_read(path_, std::generic_category().message(errno));
            }
            end_ += static_cast<std::size_t>(got);
            read_ += got;
            return got > 0;
        }
        return false;
    }

    /// Returns false once interrupted.
    bool wait_for_writer() const {
        while (!interrupted_) {
            constexpr int glance_ms = 50;  // between looks at the flag
            pollfd pipe{.fd = descriptor_, .events = POLLIN, .revents = 0};
            if (::poll(&pipe, 1, glance_ms) > 0) {
                return true;
            }
        }
        return false;
    }

    void close() noexcept {
        if (descriptor_ >= 0) {
            ::close(std::exchange(descriptor_, -1));
        }
    }

    fs::path path_;
    int descriptor_;
    bool is_pipe_ = false;
    std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
    std::size_t begin_ = 0;  // of the line, in the buffer
    std::size_t line_size_ = 0;
    std::size_t line_end_ = 0;  // where the next line begins
    std::size_t end_ = 0;       // of the bytes that were read
    std::int64_t read_ = 0;     // bytes of the file
    std::int64_t number_ = 0;   // of the line
    std::atomic<bool> interrupted_{false};
};

class CsvReader final : public RecordingReader {
public:
    explicit CsvReader(fs::path path) : path_(std::move(path)), lines_(path_) {
        read_names();
        read_metadata();
        if (head_.sample_rate_hz == 0) {
            take_rate_from_times();
        }
        ahead_ = read_row();
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        rows.values.clear();
        most = std::min(most, lines_.is_pipe() ? rows_of_a_pipe : most);
        for (std::size_t count = 0; count < most && ahead_; ++count) {
            const std::int64_t sample = sample_of(time_);
            if (count == 0) {
                rows.first = sample;
                if (sample < due_) {
                    lines_.fail("the time does not increase");
                }
            } else if (sample != due_) {
                if (sample < due_) {
                    lines_.fail("the time does not increase");
                }
                break;  // a gap
            }
            rows.values.insert(rows.values.end(), row_.begin(), row_.end());
            due_ = sample + 1;
            ahead_ = read_row();
        }
        return !rows.values.empty() && !lines_.interrupted();
    }

    void interrupt() noexcept override { lines_.interrupt(); }

private:
    void read_names() {
        const auto names = lines_.next() ? split(lines_.line(), ',') : std::vector<std::string_view>();
        if (names.size() < 2 || names.front() != csv_time_column) {
            lines_.fail(fmt::format("found the column names {}, allowed: {} and others after it",
                                    quoted_briefly(lines_.line()), csv_time_column));
        }
        for (std::size_t i = 1; i < names.size(); ++i) {
            head_.columns.push_back(column_named(printable(names[i])));
        }
        row_.resize(head_.columns.size());
    }

    /// Reads the metadata, if there are any.
    void read_metadata() {
        const fs::path path = csv_metadata_path(path_);
        std::error_code unknown;
        if (!fs::is_regular_file(path, unknown)) {
            return;
        }
        try {
            take_metadata(path);
        } catch (const std::exception& error) {
            cannot_read(path, error.what());
        }
        if (!(head_.sample_rate_hz > 0) || !std::isfinite(head_.sample_rate_hz)) {
            cannot_read(path, "urn:hertzline:sample_rate_hz: found no number above 0");
        }
    }

    void take_metadata(const fs::path& path) {
        InputFile file(path);
        const Json metadata =
            json_from_outside(file.text(std::min(file.size(), largest_metadata), "the metadata"));
        metadata.at("urn:hertzline:sample_rate_hz").get_to(head_.sample_rate_hz);
        head_.provenance = metadata.at("urn:hertzline:provenance");
        const bool single = metadata.at("tableSchema").at("columns").at(1).at("datatype") == "float";
        head_.numbers = single ? NumberType::float32 : NumberType::float64;
    }

    /// The next line's numbers to time_ and row_; false at the end.
    bool read_row() {
        if (!lines_.next()) {
            return false;
        }
        const char* at = lines_.line().data();
        const char* const end = at + lines_.line().size();
        for (std::size_t i = 0; i <= row_.size(); ++i) {
            double& number = i == 0 ? time_ : row_[i - 1];
            const auto [rest, error] = std::from_chars(at, end, number);
            const bool last = i == row_.size();
            if (error != std::errc() || (last ? rest != end : rest == end || *rest != ',')) {
                lines_.fail(fmt::format("expected {} numbers separated by commas", row_.size() + 1));
            }
            if (!std::isfinite(number)) {
                lines_.fail("found a number that is not finite");
            }
            at = rest + 1;
        }
        return true;
    }

    /// Looks at the first rows and goes back.
    void take_rate_from_times() {
        constexpr std::size_t enough_rows = 1000;
        constexpr std::int64_t enough_bytes = 1 << 20;
        if (lines_.is_pipe()) {
            cannot_read(path_, "it has no metadata, and the first times of a pipe cannot be read twice");
        }
        const Lines::Place place = lines_.place();
        std::vector<double> times;
        while (times.size() < enough_rows &&
               (times.size() < 2 || lines_.place().byte - place.byte < enough_bytes) && read_row()) {
            if (!times.empty() && time_ <= times.back()) {
                lines_.fail("the time does not increase");
            }
            times.push_back(time_);
        }
        head_.sample_rate_hz = rate_of(times);
        if (!(head_.sample_rate_hz > 0) || !std::isfinite(head_.sample_rate_hz)) {
            lines_.fail("the time does not increase");
        }
        lines_.go_back(place);
    }

    std::int64_t sample_of(double time) const {
        const double sample = time * head_.sample_rate_hz;
        const double whole = std::round(sample);
        if (!(whole >= 0) || whole > max_samples) {
            lines_.fail(
                fmt::format("found the time {}, allowed: 0 to {:g} samples", number_text(time), max_samples));
        }
        if (std::abs(sample - whole) > max_rounding) {
            lines_.fail(fmt::format("found the time {}, which is not a sample's at {} Hz", number_text(time),
                                    number_text(head_.sample_rate_hz)));
        }
        return static_cast<std::int64_t>(whole);
    }

    fs::path path_;
    Lines lines_;
    RecordingHead head_;
    bool ahead_ = false;  // the next row is in time_ and row_
    double time_ = 0;
    std::vector<double> row_;
    std::int64_t due_ = 0;  // the sample that follows
};

}  // namespace

std::unique_ptr<RecordingReader> open_csv_reader(const fs::path& path) {
    return std::make_unique<CsvReader>(path);
}

}  // namespace hertzline::recordings
