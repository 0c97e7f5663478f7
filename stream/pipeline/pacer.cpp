#include "stream/pipeline/pacer.hpp"

#include <cerrno>
#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "core/scene/text.hpp"

namespace hertzline::stream {

namespace {

__extension__ using Wide = unsigned __int128;

constexpr std::int64_t forever = std::numeric_limits<std::int64_t>::max();

}  // namespace

Pace Pace::factor(double times) {
    if (!(times >= min_factor && times <= max_factor)) {
        throw std::invalid_argument(
            fmt::format("pace factor {} is not between {} and {}", times, min_factor, max_factor));
    }
    return Pace(times);
}

tl::expected<Pace, std::string> parse_pace(std::string_view text) {
    if (text == "realtime") {
        return Pace::realtime();
    }
    if (text == "flat-out") {
        return Pace::flat_out();
    }
    const auto times = parsed_number<double>(text);
    if (!times || !(*times >= Pace::min_factor && *times <= Pace::max_factor)) {
        return tl::unexpected{fmt::format("pace \"{}\" is not realtime, flat-out or a number from {} to {}",
                                          text, Pace::min_factor, Pace::max_factor)};
    }
    return Pace::factor(*times);
}

Pacer::Pacer(double sample_rate_hz, Pace pace) {
    if (!(sample_rate_hz > 0 && sample_rate_hz <= max_sample_rate_hz)) {
        throw std::invalid_argument(
            fmt::format("sample rate {} Hz is not above 0 and at most 1e12", sample_rate_hz));
    }
    if (pace.is_flat_out()) {
        return;
    }
    const double rate = sample_rate_hz * pace.times();
    samples_per_ns_ = rate * 1e-9;
    // 53 bits are a double's whole mantissa; dropping trailing zeros keeps the shifts below short.
    mantissa_ = static_cast<std::uint64_t>(std::ldexp(std::frexp(rate, &exponent_), 53));
    exponent_ -= 53;
    while (mantissa_ != 0 && mantissa_ % 2 == 0) {
        mantissa_ /= 2;
        ++exponent_;
    }
}

Nanoseconds Pacer::due(std::uint64_t sample) const noexcept {
    if (flat_out() || sample == 0) {
        return start_;
    }
    const double estimate = static_cast<double>(sample) / samples_per_ns_;
    if (!(estimate < 0.999 * static_cast<double>(forever))) {
        return Nanoseconds{forever};
    }
    // nanoseconds = sample * 1e9 / (mantissa * 2^exponent). No overflow in 128 bits: sample * 1e9 < 2^94;
    // with a negative exponent the numerator is below (result + 1) * mantissa < 2^63 * 2^53; with a positive
    // one the denominator is the rate, at most 1e18.
    Wide numerator = Wide{sample} * 1'000'000'000U;
    Wide denominator = mantissa_;
    if (exponent_ < 0) {
        numerator <<= -exponent_;
    } else {
        denominator <<= exponent_;
    }
    const auto elapsed = static_cast<std::int64_t>(numerator / denominator);
    if (start_.count() > 0 && elapsed > forever - start_.count()) {
        return Nanoseconds{forever};
    }
    return start_ + Nanoseconds{elapsed};
}

Nanoseconds MonotonicClock::now() noexcept {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return Nanoseconds{static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec};
}

void MonotonicClock::sleep_until(Nanoseconds time) noexcept {
    const timespec deadline{.tv_sec = time.count() / 1'000'000'000, .tv_nsec = time.count() % 1'000'000'000};
    // An absolute deadline: a thread that is preempted on its way here does not sleep longer for it.
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

}  // namespace hertzline::stream
