#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "recordings/columns.hpp"
#include "recordings/files/errors.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/csv.hpp"
#include "recordings/formats/csv_metadata.hpp"
#include "recordings/isolated_reader.hpp"
#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

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

class CsvReader final : public RecordingReader {
public:
    explicit CsvReader(fs::path path) : path_(std::move(path)), in_(path_, std::ios::binary) {
        if (!in_ || fs::is_directory(path_)) {
            cannot_read(path_, "not a file");
        }
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
        for (std::size_t count = 0; count < most && ahead_; ++count) {
            const std::int64_t sample = sample_of(time_);
            if (count == 0) {
                rows.first = sample;
                if (sample < due_) {
                    fail("the time does not increase");
                }
            } else if (sample != due_) {
                if (sample < due_) {
                    fail("the time does not increase");
                }
                break;  // a gap
            }
            rows.values.insert(rows.values.end(), row_.begin(), row_.end());
            due_ = sample + 1;
            ahead_ = read_row();
        }
        return !rows.values.empty();
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw std::runtime_error(fmt::format("{}:{}: {}", path_.string(), line_number_, what));
    }

    /// Into a buffer that grows with the line, and no further than a line may be long.
    bool read_line() {
        std::size_t length = 0;
        for (;;) {
            if (buffer_.size() - length < 2) {
                buffer_.resize(2 * buffer_.size());
            }
            in_.getline(buffer_.data() + length, static_cast<std::streamsize>(buffer_.size() - length));
            const auto got = static_cast<std::size_t>(in_.gcount());
            length += got;
            if (in_.eof() || !in_.fail()) {
                break;
            }
            in_.clear();  // the buffer is full
            const bool too_long = buffer_.size() >= longest_line;
            if (too_long || std::memchr(buffer_.data(), 0, length) != nullptr) {
                ++line_number_;
                fail(too_long ? "the line is too long" : "found a byte 0, allowed: text");
            }
        }
        if (in_.eof() && length == 0) {
            return false;
        }
        length -= in_.eof() ? 0 : 1;  // the end of the line was taken, too
        ++line_number_;
        line_.assign(buffer_.data(), length);
        if (!line_.empty() && line_.back() == '\r') {
            line_.pop_back();
        }
        return true;
    }

    void read_names() {
        const auto names = read_line() ? split(line_, ',') : std::vector<std::string_view>();
        if (names.size() < 2 || names.front() != csv_time_column) {
            line_number_ = 1;
            fail(fmt::format("found the column names {}, allowed: {} and others after it",
                             quoted_briefly(line_), csv_time_column));
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
        if (!read_line()) {
            return false;
        }
        const char* at = line_.data();
        const char* const end = at + line_.size();
        for (std::size_t i = 0; i <= row_.size(); ++i) {
            double& number = i == 0 ? time_ : row_[i - 1];
            const auto [rest, error] = std::from_chars(at, end, number);
            const bool last = i == row_.size();
            if (error != std::errc() || (last ? rest != end : rest == end || *rest != ',')) {
                fail(fmt::format("expected {} numbers separated by commas", row_.size() + 1));
            }
            if (!std::isfinite(number)) {
                fail("found a number that is not finite");
            }
            at = rest + 1;
        }
        return true;
    }

    /// Looks at the first rows and goes back.
    void take_rate_from_times() {
        constexpr std::size_t enough_rows = 1000;
        constexpr std::int64_t enough_bytes = 1 << 20;
        const auto place = in_.tellg();
        if (place < 0) {
            cannot_read(path_, "it has no metadata, and the first times of a pipe cannot be read twice");
        }
        const std::int64_t line = line_number_;
        std::vector<double> times;
        while (times.size() < enough_rows && (times.size() < 2 || in_.tellg() - place < enough_bytes) &&
               read_row()) {
            if (!times.empty() && time_ <= times.back()) {
                fail("the time does not increase");
            }
            times.push_back(time_);
        }
        head_.sample_rate_hz = rate_of(times);
        if (!(head_.sample_rate_hz > 0) || !std::isfinite(head_.sample_rate_hz)) {
            fail("the time does not increase");
        }
        in_.clear();
        in_.seekg(place);
        line_number_ = line;
    }

    std::int64_t sample_of(double time) const {
        const double sample = time * head_.sample_rate_hz;
        const double whole = std::round(sample);
        if (!(whole >= 0) || whole > max_samples) {
            fail(
                fmt::format("found the time {}, allowed: 0 to {:g} samples", number_text(time), max_samples));
        }
        if (std::abs(sample - whole) > max_rounding) {
            fail(fmt::format("found the time {}, which is not a sample's at {} Hz", number_text(time),
                             number_text(head_.sample_rate_hz)));
        }
        return static_cast<std::int64_t>(whole);
    }

    fs::path path_;
    std::ifstream in_;
    RecordingHead head_;
    std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
    std::string line_;
    std::int64_t line_number_ = 0;
    bool ahead_ = false;  // the next row is in time_ and row_
    double time_ = 0;
    std::vector<double> row_;
    std::int64_t due_ = 0;  // the sample that follows
};

}  // namespace

std::unique_ptr<RecordingReader> open_csv_reader(const fs::path& path) {
    std::error_code unknown;
    if (fs::is_fifo(path, unknown) && fs::is_regular_file(csv_metadata_path(path), unknown)) {
        // The writer of a pipe may stay silent for ever, and only killing the reading process ends the wait.
        return open_isolated_reader(
            path, std::make_unique<ChildProcess>(
                      reading([&path] { return std::make_unique<CsvReader>(path); }, rows_of_a_pipe),
                      ChildLimits{.silence = std::nullopt}));
    }
    return std::make_unique<CsvReader>(path);
}

}  // namespace hertzline::recordings
