#pragma once
// The times at which samples are due. Simulated time runs at `factor` times wall time, from one start on: every
// deadline is computed from the sample's index, none from the deadline before it, so days of streaming do not drift.

#include <algorithm>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace hertzline::stream {

using Nanoseconds = std::chrono::duration<std::int64_t, std::nano>;

constexpr double seconds(Nanoseconds time) noexcept {
    return std::chrono::duration<double>(time).count();
}

/// The rate of simulated time.
class Pace {
public:
    static constexpr Pace flat_out() noexcept { return Pace(0); }
    static constexpr Pace realtime() noexcept { return Pace(1); }
    /// `times` simulated seconds in each second.
    /// @throws std::invalid_argument outside [min_factor, max_factor]
    static Pace factor(double times);

    constexpr bool is_flat_out() const noexcept { return times_ == 0; }
    /// Simulated seconds per second; 0 when flat out.
    constexpr double times() const noexcept { return times_; }
    bool operator==(const Pace&) const = default;

    static constexpr double min_factor = 1e-6;
    static constexpr double max_factor = 1e6;

private:
    constexpr explicit Pace(double times) noexcept : times_(times) {}
    double times_;
};

/// Reads "realtime", "flat-out" or a number from Pace::min_factor to Pace::max_factor.
tl::expected<Pace, std::string> parse_pace(std::string_view text);

/// Beyond it deadlines would not be exact.
inline constexpr double max_sample_rate_hz = 1e12;

/// Deadlines of samples, in the time of a clock that the caller reads. Never waits and never looks at a clock.
class Pacer {
public:
    /// @throws std::invalid_argument unless 0 < sample_rate_hz <= 1e12.
    Pacer(double sample_rate_hz, Pace pace);
    Pacer(double sample_rate_hz, double factor) : Pacer(sample_rate_hz, Pace::factor(factor)) {}

    /// Sample 0 is due now.
    void start(Nanoseconds now) noexcept { start_ = now; }

    /// The time at which the sample is due: start + sample / (rate * factor), rounded down to a nanosecond, exact for
    /// the product rate * factor as a double. Flat out: always the start. Beyond 292 years: the largest time.
    Nanoseconds due(std::uint64_t sample) const noexcept;

    /// The lateness; negative when there is time left; 0 flat out.
    Nanoseconds lateness(Nanoseconds now, std::uint64_t sample) const noexcept {
        return flat_out() ? Nanoseconds{0} : now - due(sample);
    }

    bool flat_out() const noexcept { return mantissa_ == 0; }

private:
    // Samples per second of wall time, as the exact fraction mantissa * 2^exponent that every double is.
    std::uint64_t mantissa_ = 0;
    int exponent_ = 0;
    double samples_per_ns_ = 0;
    Nanoseconds start_{0};
};

/// A clock to wait with. sleep_until may return early (a signal), never later than it must.
template <class Clock>
concept PacingClock = requires(Clock& clock, Nanoseconds time) {
    { clock.now() } -> std::same_as<Nanoseconds>;
    clock.sleep_until(time);
};

/// The machine's monotonic clock; suspended time does not count.
struct MonotonicClock {
    static Nanoseconds now() noexcept;
    static void sleep_until(Nanoseconds time) noexcept;
};

/// Waits until the sample is due, waking at least every 50 ms to ask keep_going(). Returns the lateness found
/// on arrival: positive, the caller came too late and nothing was waited for.
template <PacingClock Clock, std::predicate KeepGoing>
Nanoseconds wait_until_due(Clock& clock, const Pacer& pacer, std::uint64_t sample, KeepGoing keep_going) {
    // Short enough for Ctrl-C to be noticed at once even when a slow pace leaves minutes between two frames.
    constexpr Nanoseconds longest_nap = std::chrono::milliseconds(50);
    const Nanoseconds deadline = pacer.due(sample);
    Nanoseconds now = clock.now();
    const Nanoseconds found = pacer.lateness(now, sample);
    if (pacer.flat_out()) {
        return found;
    }
    while (now < deadline && keep_going()) {
        clock.sleep_until(std::min(deadline, now + longest_nap));
        now = clock.now();
    }
    return found;
}

}  // namespace hertzline::stream
