#include "recordings/time_axis.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/scene/text.hpp"

namespace hertzline::recordings {

namespace {

constexpr double max_samples = 5e14;    // times up to there distinguish samples
constexpr double max_deviation = 0.25;  // of a time from its sample's, in samples
constexpr double usual_noise = 1e-3;    // of times that were summed up, in samples

/// Names of a column of times, in small letters, before a unit.
constexpr std::array<std::string_view, 9> time_names{"t",     "time",   "zeit", "temps", "tiempo",
                                                     "tempo", "x-axis", "in",   "__time"};

struct TimeUnit {
    std::string_view name;
    double seconds;
};
constexpr std::array time_units{TimeUnit{"", 1},         TimeUnit{"s", 1},          TimeUnit{"sec", 1},
                                TimeUnit{"second", 1},   TimeUnit{"seconds", 1},    TimeUnit{"ms", 1e-3},
                                TimeUnit{"us", 1e-6},    TimeUnit{"\u00b5s", 1e-6}, TimeUnit{"\u03bcs", 1e-6},
                                TimeUnit{"\xb5s", 1e-6},  // in Latin-1
                                TimeUnit{"ns", 1e-9},    TimeUnit{"ps", 1e-12}};

/// Rounds to that many digits.
double rounded(double number, int digits) {
    double result = 0;
    const std::string text = fmt::format("{:.{}g}", number, digits);
    std::from_chars(text.data(), text.data() + text.size(), result);
    return result;
}

/// Rates that times keep to.
struct RateRange {
    double low = 0;
    double high = std::numeric_limits<double>::infinity();
    double middle = 0;

    bool contains(double rate) const noexcept { return low <= rate && rate <= high; }
};

/// Rates of the leading times that keep to any.
struct RateSearch {
    RateRange range;
    std::size_t kept = 1;  // times

    /// @param noise of each time beside its rounding, in samples
    RateSearch(std::span<const double> times, const TimeDigits& digits, double noise) {
        double samples = 0;
        for (; kept < times.size() && times[kept] > times[kept - 1]; ++kept) {
            const double since = times[kept] - times[0];
            const double unit = std::max(digits.last_place(times[kept]), digits.last_place(times[0]));
            const double least = std::ceil(std::max(0.0, since - unit) * range.low - noise);
            const double most = std::floor((since + unit) * range.high + noise);
            if (least > most || samples + 1 > most || (samples + 1 < least && least != most)) {
                return;
            }
            samples = std::max(samples + 1, least);
            RateRange narrower = range;
            narrower.low = std::max(range.low, (samples - noise) / (since + unit));
            if (since > unit) {
                narrower.high = std::min(range.high, (samples + noise) / (since - unit));
            }
            narrower.middle = samples / since;
            if (narrower.low > narrower.high) {
                return;
            }
            range = narrower;
        }
    }
};

double plainest(const RateRange& range) {
    for (int digits = 1; digits < std::numeric_limits<double>::max_digits10; ++digits) {
        for (const double rate : {rounded(range.middle, digits), 1 / rounded(1 / range.middle, digits)}) {
            if (range.contains(rate)) {
                return rate;
            }
        }
    }
    return range.middle;
}

/// Whether all times are those of samples that follow one another at the beginning.
bool keeps_to(double rate, std::span<const double> times, const TimeDigits& digits) {
    TimeAxis axis(rate, digits);
    try {
        const std::int64_t first = axis.sample_of(times[0]);
        return axis.sample_of(times[1]) == first + 1 &&
               std::ranges::all_of(times.subspan(2), [&](double time) {
                   axis.sample_of(time);
                   return true;
               });
    } catch (const std::runtime_error&) {
        return false;
    }
}

}  // namespace

std::optional<double> unit_of_time(std::string_view text) {
    const std::string unit = lower_case(trimmed(text, " ()[]_/,"));
    const auto* const found = std::ranges::find(time_units, unit, &TimeUnit::name);
    return found != time_units.end() ? std::optional(found->seconds) : std::nullopt;
}

std::optional<double> unit_of_time_column(std::string_view name) {
    const std::string text = lower_case(name);
    for (const std::string_view base : time_names) {
        const std::string_view unit = std::string_view(text).substr(std::min(base.size(), text.size()));
        const bool ends = unit.empty() ? base != "in"  // that is an input
                                       : std::string_view(" ([_/,").find(unit[0]) != std::string_view::npos;
        if (text.starts_with(base) && ends) {
            return unit_of_time(unit);
        }
    }
    return std::nullopt;
}

void TimeDigits::count(std::string_view text) noexcept {
    const std::size_t exponent_at = text.find_first_of("eE");
    const std::string_view mantissa = text.substr(0, exponent_at);
    int exponent = 0;
    if (exponent_at != std::string_view::npos) {
        std::string_view number = text.substr(exponent_at + 1);
        number.remove_prefix(number.starts_with('+') ? 1 : 0);
        std::from_chars(number.data(), number.data() + number.size(), exponent);
    }
    constexpr int most = 400;  // no number has more
    int behind_point = 0;
    int of_mantissa = 0;
    bool after_point = false;
    for (const char c : mantissa) {
        after_point = after_point || c == '.' || c == ',';
        if (c >= '0' && c <= '9') {
            behind_point += after_point ? 1 : 0;
            of_mantissa += of_mantissa > 0 || c != '0' ? 1 : 0;
        }
    }
    decimals = std::max(decimals, std::clamp(behind_point - std::clamp(exponent, -most, most), -most, most));
    significant = std::max(significant, std::min(of_mantissa, most));
}

double TimeDigits::last_place(double time) const noexcept {
    const double size = std::max(std::abs(time), std::numeric_limits<double>::min());
    const double as_number = 4 * std::numeric_limits<double>::epsilon() * size;
    const double as_rounded = std::pow(10.0, std::floor(std::log10(size)) - significant + 1);
    return std::max({as_number, as_rounded, std::pow(10.0, -decimals)});
}

std::optional<double> rate_of_times(std::span<const double> times, const TimeDigits& digits) {
    if (times.size() < 2) {
        return std::nullopt;
    }
    std::size_t kept = 1;
    double rate = 0;  // of those
    for (const auto& [rounding, noise] :
         {std::pair{digits_of_float64, 0.0}, std::pair{digits, 0.0}, std::pair{digits, usual_noise}}) {
        const RateSearch search(times, rounding, noise);
        if (search.kept > kept) {
            kept = search.kept;
            rate = plainest(search.range);
        }
        if (kept == times.size() && rate > 0 && std::isfinite(rate)) {
            return rate;
        }
    }
    kept = std::min(kept, times.size() - 1);
    throw TimeFault(
        kept,
        times[kept] > times[kept - 1]
            ? fmt::format(
                  "found the time {}, which is not a sample's at {} Hz, the rate of the times "
                  "before; allowed: that of a sample, to its last digit, or a sample rate that is given",
                  number_text(times[kept]), number_text(rate))
            : "the time does not increase");
}

TimeAxis::TimeAxis(std::optional<double> given_hz, std::span<const double> times, const TimeDigits& digits)
    : digits_(digits) {
    if (given_hz && (times.size() < 2 || keeps_to(*given_hz, times, digits))) {
        rate_ = *given_hz;
    } else {
        try {
            rate_ = rate_of_times(times, digits).value_or(0);
        } catch (const TimeFault&) {
            if (!given_hz) {
                throw;
            }
            rate_ = *given_hz;
        }
    }
    if (!times.empty() && times[0] * rate_ > max_samples) {
        origin_ = times[0];
    }
}

/// Returns the greatest deviation of a time from its sample's, in samples.
double TimeAxis::tolerance(double time) const noexcept {
    const double rounding = std::max(digits_.last_place(time), digits_.last_place(origin_)) * rate_;
    return rounding > 1 ? rounding : std::max(max_deviation, rounding / 2);
}

std::optional<std::string> TimeAxis::moved_origin(const std::string& file) const {
    return origin_ == 0 ? std::nullopt
                        : std::optional(fmt::format("{}: its times begin at {} s, which becomes 0", file,
                                                    number_text(origin_)));
}

std::int64_t TimeAxis::sample_of(double time) {
    if (rate_ == 0 ||
        (due_ > 0 && std::abs((time - origin_) * rate_ - static_cast<double>(due_)) <= max_deviation)) {
        return due_++;
    }
    const double absolute = time * rate_;
    if (due_ == 0 && !(absolute >= 0 && std::abs(absolute - std::round(absolute)) <= tolerance(time))) {
        origin_ = time;
    }
    const double place = (time - origin_) * rate_;
    const double tolerated = tolerance(time);
    if (due_ > 0 && std::abs(place - static_cast<double>(due_)) <= tolerated) {
        return due_++;
    }
    const double sample = std::round(place);
    if (sample < static_cast<double>(due_)) {
        throw std::runtime_error("the time does not increase");
    }
    if (!(sample <= max_samples)) {
        throw std::runtime_error(
            fmt::format("found the time {}, allowed: at most {:g} samples", number_text(time), max_samples));
    }
    if (std::abs(place - sample) > tolerated || (tolerated > 1 && due_ > 0)) {
        throw std::runtime_error(fmt::format("found the time {}, which is not a sample's at {} Hz",
                                             number_text(time), number_text(rate_)));
    }
    due_ = static_cast<std::int64_t>(sample);
    return due_++;
}

}  // namespace hertzline::recordings
