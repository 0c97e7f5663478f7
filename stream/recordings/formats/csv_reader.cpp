#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "core/scene/text.hpp"
#include "stream/files/errors.hpp"
#include "stream/files/input_file.hpp"
#include "stream/json_from_outside.hpp"
#include "stream/recordings/columns.hpp"
#include "stream/recordings/formats/csv.hpp"

namespace hertzline::stream {

namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

constexpr std::size_t longest_line = std::size_t{1} << 29;  // 20 million numbers, as of the longest chain
constexpr std::uint64_t largest_metadata = 64 << 20;
constexpr double max_samples = 5e14;   // times up to there tell them apart
constexpr double max_rounding = 0.25;  // of a sample, in such a time

std::vector<std::string> split(std::string_view line) {
    std::vector<std::string> parts;
    for (;;) {
        const std::size_t comma = line.find(',');
        parts.emplace_back(line.substr(0, comma));
        if (comma == std::string_view::npos) {
            return parts;
        }
        line.remove_prefix(comma + 1);
    }
}

/// The rate that the times of two neighbours tell. They have lost digits by then, rates are seldom that crooked.
double rate_between(double t0, double t1) {
    double rate = 0;
    const std::string rounded = fmt::format("{:.9g}", 1 / (t1 - t0));
    std::from_chars(rounded.data(), rounded.data() + rounded.size(), rate);
    return rate;
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

    bool read_line() {
        if (!std::getline(in_, line_)) {
            return false;
        }
        ++line_number_;
        if (line_.size() > longest_line) {
            fail("the line is too long");
        }
        if (!line_.empty() && line_.back() == '\r') {
            line_.pop_back();
        }
        return true;
    }

    void read_names() {
        const std::vector<std::string> names = read_line() ? split(line_) : std::vector<std::string>();
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

    /// What the metadata say, where there are some.
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

    /// Looks at the first two rows and goes back.
    void take_rate_from_times() {
        const auto place = in_.tellg();
        const std::int64_t line = line_number_;
        head_.sample_rate_hz = 1;  // of a single sample nobody can tell
        if (read_row()) {
            const double first = time_;
            if (read_row()) {
                head_.sample_rate_hz = rate_between(first, time_);
            }
        }
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
    std::string line_;
    std::int64_t line_number_ = 0;
    bool ahead_ = false;  // the next row is in time_ and row_
    double time_ = 0;
    std::vector<double> row_;
    std::int64_t due_ = 0;  // the sample that follows
};

}  // namespace

std::unique_ptr<RecordingReader> open_csv_reader(const fs::path& path) {
    return std::make_unique<CsvReader>(path);
}

}  // namespace hertzline::stream
