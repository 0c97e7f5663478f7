#pragma once
// The samples that the times of a file's rows belong to.
//
// The rate is that of the times as they stand. Where they keep to none they are rounded, each to its last digit: of the
// rates that all of them keep to within that digit the plainest is theirs, whose digits, or those of its period, are the
// fewest.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hertzline::recordings {

/// How finely a column of times is given.
struct TimeDigits {
    int decimals = 0;     ///< behind the point, at most
    int significant = 0;  ///< at most

    /// Counts those of one more time. @param text of a number: "2.10e-05" has 7 decimals, 3 significant digits
    void count(std::string_view text) noexcept;
    /// Returns the place value of the last digit of a time [s].
    double last_place(double time) const noexcept;
};

/// The digits of times that are numbers in a file.
inline constexpr TimeDigits digits_of_float64{400, 16}, digits_of_float32{400, 7};

/// Returns a unit of time in seconds: "ms", "(ms)", "" (seconds); nothing for another one.
std::optional<double> unit_of_time(std::string_view text);

/// Returns the unit of a column that is named like a time, in seconds: "t_s", "Time (ms)", "in s"; nothing for other names.
std::optional<double> unit_of_time_column(std::string_view name);

/// A time that is not a sample's.
class TimeFault : public std::runtime_error {
public:
    TimeFault(std::size_t row, const std::string& fault) : std::runtime_error(fault), row_(row) {}
    std::size_t row() const noexcept { return row_; }

private:
    std::size_t row_;
};

/// Returns the rate that times keep to; nothing when they are fewer than two. The second time is that of the sample after the
/// first. @throws TimeFault at the first one that keeps to no rate of those before
std::optional<double> rate_of_times(std::span<const double> times, const TimeDigits& digits);

/// Gives each time of a file, in turn, its sample.
class TimeAxis {
public:
    /// Counts rows, without times.
    TimeAxis() = default;
    /// Samples are counted from the time 0 on; from the first row on when that one is before 0 or between two samples, or, in a file of
    /// another program, so late (a date's time) that samples could not be told apart.
    TimeAxis(double sample_rate_hz, const TimeDigits& digits) : rate_(sample_rate_hz), digits_(digits) {}

    /// The axis of a file that does not tell its rate: with the given one, unless the times keep to another.
    /// @param times of its first rows @throws TimeFault when none is given and the times keep to none
    TimeAxis(std::optional<double> given_hz, std::span<const double> times, const TimeDigits& digits);

    /// 0: neither is it given, nor do the times tell.
    double sample_rate_hz() const noexcept { return rate_; }

    /// Returns the sample of the next row. @throws std::runtime_error with the fault, when it is not a later sample's time
    std::int64_t sample_of(double time);

    /// Returns a warning where the first row's time, which is not 0, has become 0; it is known behind that row. @param file its name
    std::optional<std::string> moved_origin(const std::string& file) const;

private:
    double tolerance(double time) const noexcept;

    double rate_ = 0;
    TimeDigits digits_;
    double origin_ = 0;     // time of sample 0
    std::int64_t due_ = 0;  // the sample that follows; 0: the first row is next
};

}  // namespace hertzline::recordings
