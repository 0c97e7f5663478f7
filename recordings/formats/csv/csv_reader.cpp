#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/csv/csv.hpp"
#include "recordings/formats/csv/csv_dialect.hpp"
#include "recordings/formats/csv/csv_lines.hpp"
#include "recordings/time_axis.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t largest_metadata = 64 << 20;
constexpr std::size_t rows_of_a_pipe = 16;  // at a time: few, as they may come slowly

class CsvReader final : public RecordingReader {
public:
    CsvReader(fs::path path, ReadOptions options)
        : path_(std::move(path)),
          options_(std::move(options)),
          lines_(path_, options_.stop),
          names_(read_csv_names(lines_, options_.sample_rate_hz.has_value())),
          numbers_(names_),
          row_(names_.columns.size()) {
        head_.columns = names_.columns;
        if (!names_.has_times) {
            head_.sample_rate_hz = *options_.sample_rate_hz;
        } else if (!read_metadata()) {
            take_rate_from_times();
        }
        ahead_ = names_.has_rows && read_row();
        if (const auto moved = axis_.moved_origin(printable_whole(path_.string()))) {
            options_.tell(*moved);
        }
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        rows.values.clear();
        most = std::min(most, lines_.is_pipe() ? rows_of_a_pipe : most);
        for (std::size_t count = 0; count < most && ahead_; ++count) {
            if (count == 0) {
                rows.first = sample_;
            } else if (sample_ != due_) {
                break;  // a gap
            }
            rows.values.insert(rows.values.end(), row_.begin(), row_.end());
            due_ = sample_ + 1;
            ahead_ = next_row();
        }
        return !rows.values.empty() && !lines_.stopped();
    }

    void interrupt() noexcept override { lines_.interrupt(); }

private:
    /// Reads the metadata. Returns false when there are none, or those of another table.
    bool read_metadata() {
        const fs::path path = csv_metadata_path(path_);
        std::error_code unknown;
        if (!fs::is_regular_file(path, unknown)) {
            return false;
        }
        Json metadata;
        try {
            InputFile file(path);
            metadata = json_from_outside(file.text(std::min(file.size(), largest_metadata), "the metadata"));
        } catch (const std::exception& error) {
            cannot_read(path, error.what());
        }
        const OutsideJson described(metadata);
        const double rate = described.number("urn:hertzline:sample_rate_hz").value_or(0);
        const Json& columns = described.at("tableSchema/columns");
        const auto left_out = [&](const std::string& why) {
            options_.tell(printable_whole(path.string()) + ": left out, because " + why);
            return false;
        };
        if (!(rate > 0) || !std::isfinite(rate)) {
            return left_out("it has no urn:hertzline:sample_rate_hz above 0");
        }
        if (!are_those_of_the_file(columns)) {
            return left_out("it describes other columns");
        }
        if (!lines_.is_pipe() && !is_rate_of_the_times(rate)) {
            return left_out("the times are not those of its " + number_text(rate) + " Hz");
        }
        head_.sample_rate_hz = rate;
        head_.provenance = described.at("urn:hertzline:provenance");
        head_.numbers =
            OutsideJson(columns[1]).text("datatype") == "float" ? NumberType::float32 : NumberType::float64;
        axis_ = TimeAxis(rate, digits_of_float64);
        return true;
    }

    bool are_those_of_the_file(const Json& columns) const {
        const auto is = [](const Json& column, const std::string& name) {
            return OutsideJson(column).text("name") == name;
        };
        return columns.is_array() && columns.size() == names_.columns.size() + 1 && is(columns[0], "t_s") &&
               std::equal(columns.begin() + 1, columns.end(), names_.columns.begin(),
                          [&](const Json& column, const Column& own) { return is(column, own.name); });
    }

    /// Whether the first rows are samples at that rate, to within the last digits of their times, and some follow each other.
    bool is_rate_of_the_times(double rate_hz) {
        constexpr std::size_t enough_rows = 1000;
        constexpr double rounding = 1e-3;  // of a sample
        TimeDigits digits;
        const std::vector<double> times = first_times(digits, enough_rows);
        double shortest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < times.size(); ++i) {
            const double sample = times[i] * rate_hz;
            if (std::abs(sample - std::round(sample)) > digits.last_place(times[i]) * rate_hz + rounding) {
                return false;
            }
            shortest = i > 0 ? std::min(shortest, sample - times[i - 1] * rate_hz) : shortest;
        }
        return times.size() < 2 || std::round(shortest) == 1;
    }

    /// Without times nothing shows that a sample is missing but its empty line.
    bool next_row() {
        std::string empty;
        if (!CsvNumbers::next(lines_, &empty)) {
            return false;
        }
        if (!names_.has_times && !empty.empty()) {
            throw std::runtime_error(empty +
                                     ": found no number between two samples, allowed: one for each, or a "
                                     "column of times, which shows gaps");
        }
        return read_row();
    }

    /// Reads the numbers of the present line; false when the file stops within it.
    bool read_row() {
        if (!lines_.is_ended()) {
            options_.tell(lines_.name() +
                          ": left out, because the file ends within this line or right behind it");
            return false;
        }
        double time = 0;
        numbers_.read(lines_, time, row_);
        if (!names_.has_times) {
            sample_ = rows_++;
            return true;
        }
        try {
            sample_ = axis_.sample_of(time * names_.time_unit_s);
        } catch (const std::runtime_error& error) {
            lines_.fail(error.what());
        }
        return true;
    }

    /// Looks at the first rows and goes back.
    void take_rate_from_times() {
        if (lines_.is_pipe() && !options_.sample_rate_hz) {
            cannot_read(path_,
                        "it has no metadata, and the first times of a pipe cannot be read twice: give its "
                        "sample rate");
        }
        if (lines_.is_pipe()) {
            axis_ = TimeAxis(*options_.sample_rate_hz, digits_of_float64);
        } else {
            TimeDigits digits;
            const std::vector<double> times = first_times(digits);
            try {
                axis_ = TimeAxis(options_.sample_rate_hz, times, digits);
            } catch (const TimeFault& fault) {
                go_to_row(fault.row());
                lines_.fail(fault.what());
            }
        }
        head_.sample_rate_hz = axis_.sample_rate_hz();
    }

    void go_to_row(std::size_t row) {
        lines_.go_back(names_.first_row);
        for (std::size_t i = 0; i <= row; ++i) {
            CsvNumbers::next(lines_);
        }
    }

    /// Returns the times of the first rows, up to one that is not above the one before, and goes back to the first.
    std::vector<double> first_times(TimeDigits& digits, std::size_t enough_rows = 100'000) {
        constexpr std::int64_t enough_bytes = 16 << 20;
        std::vector<double> times;
        CsvNumbers numbers(names_);
        for (bool more = names_.has_rows; more && lines_.is_ended() && times.size() < enough_rows;) {
            times.push_back(numbers.time(lines_, digits) * names_.time_unit_s);
            const bool increases = times.size() < 2 || times.back() > times[times.size() - 2];
            more = increases && lines_.place().byte - names_.first_row.byte < enough_bytes &&
                   CsvNumbers::next(lines_);
        }
        go_to_row(0);
        digits.decimals -= static_cast<int>(std::round(std::log10(names_.time_unit_s)));
        return times;
    }

    fs::path path_;
    ReadOptions options_;
    CsvLines lines_;
    CsvNames names_;
    CsvNumbers numbers_;
    TimeAxis axis_;
    RecordingHead head_;
    bool ahead_ = false;  // the next row is in sample_ and row_
    std::int64_t sample_ = 0;
    std::int64_t rows_ = 0;  // so far, of a file without times
    std::vector<double> row_;
    std::int64_t due_ = 0;  // the sample that follows
};

}  // namespace

std::unique_ptr<RecordingReader> open_csv_reader(const fs::path& path, const ReadOptions& options) {
    return std::make_unique<CsvReader>(path, options);
}

}  // namespace hertzline::recordings
